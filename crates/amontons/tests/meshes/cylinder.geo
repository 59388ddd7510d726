// A cylinder of radius 1 and height 2, of quadratic tetrahedra with curved faces; the upper half is a region of its own.
SetFactory("OpenCASCADE");
Cylinder(1) = {0, 0, 0, 0, 0, 1, 1};
Cylinder(2) = {0, 0, 1, 0, 0, 1, 1};
Coherence;
Physical Volume("back plate", 1) = {1};
Physical Volume("pad", 2) = {2};
// The round faces below and above, the ends.
Physical Surface("side", 3) = {1, 4};
Physical Surface("bottom", 1) = {3};
Physical Surface("top", 2) = {5};
Mesh.ElementOrder = 2;
Mesh.SecondOrderLinear = 0;
Mesh.MeshSizeMin = 1.2;
Mesh.MeshSizeMax = 1.2;
