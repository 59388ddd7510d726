// A hub on a shaft, in m: two cylinders of hexahedra whose facets do not match, 32 cells around the shaft and 28 around the bore.
//
//     gmsh -3 press-fit.geo -o press-fit.msh

SetFactory("OpenCASCADE");
radius = 10e-3;  outer = 20e-3;
Mesh.RecombinationAlgorithm = 3;
Mesh.Algorithm = 8;

Disk(1) = {0, 0, 0, radius};
Disk(2) = {0, 0, 5e-3, outer};
Disk(3) = {0, 0, 5e-3, radius};
BooleanDifference(4) = { Surface{2}; Delete; }{ Surface{3}; Delete; };

of_shaft() = Boundary { Surface{1}; };
of_hub() = Boundary { Surface{4}; };
Transfinite Curve {of_shaft()} = 33;
Transfinite Curve {of_hub()} = 29;
Mesh.MeshSizeMax = 3e-3;
Recombine Surface {1, 4};

shaft() = Extrude {0, 0, 30e-3} { Surface{1}; Layers{10}; Recombine; };
hub() = Extrude {0, 0, 20e-3} { Surface{4}; Layers{6}; Recombine; };

Physical Volume("shaft") = {shaft(1)};
Physical Surface("shaft_bottom") = {1};
Physical Surface("shaft_outer") = {shaft(2)};
Physical Volume("hub") = {hub(1)};
Physical Surface("hub_bottom") = {4};
far = 1e-6;
bore() = Surface In BoundingBox {-radius - far, -radius - far, 5e-3 - far, radius + far, radius + far, 25e-3 + far};
Physical Surface("hub_inner") = {bore()};
Physical Surface("hub_outer") = {hub({2 : 3})};
Physical Surface("hub_outer") -= {bore()};
