// Hexahedra below a face that is part of a cylinder, tetrahedra above it, pyramids between them. With -order 2 they have
// 27, 10 and 14 nodes, with -setnumber Mesh.SecondOrderIncomplete 1 as well 20, 10 and 13.
SetFactory("Built-in");
Point(1) = {0, 0, 0}; Point(2) = {1, 0, 0}; Point(3) = {1, 0, 0.5}; Point(4) = {0, 0, 0.5};
Point(5) = {1, 0, 1.1}; Point(6) = {0, 0, 1.1}; Point(7) = {0.5, 0, -0.7};
Line(1) = {1, 2}; Line(2) = {2, 3}; Circle(3) = {3, 7, 4}; Line(4) = {4, 1};
Line(5) = {3, 5}; Line(6) = {5, 6}; Line(7) = {6, 4};
Curve Loop(1) = {1, 2, 3, 4}; Plane Surface(1) = {1};
Curve Loop(2) = {5, 6, 7, -3}; Plane Surface(2) = {2};
Transfinite Curve {1, 2, 3, 4} = 3;
Transfinite Surface {1}; Recombine Surface {1};
below[] = Extrude {0, 0.8, 0} { Surface{1}; Layers{2}; Recombine; };
above[] = Extrude {0, 0.8, 0} { Surface{2}; };
Physical Volume("below", 1) = {below[1]};
Physical Volume("above", 2) = {above[1]};
Physical Surface("bottom", 3) = {below[2]};
Physical Surface("top", 4) = {above[3]};
Physical Surface("front", 5) = {1, 2};
Mesh.MeshSizeMin = 0.6;
Mesh.MeshSizeMax = 0.6;
