// A quarter of a ring, radii 1 and 2, of quadratic triangles with curved edges.
SetFactory("Built-in");
Point(1) = {0, 0, 0, 0.5};
Point(2) = {1, 0, 0, 0.5};
Point(3) = {2, 0, 0, 0.5};
Point(4) = {0, 2, 0, 0.5};
Point(5) = {0, 1, 0, 0.5};
Line(1) = {2, 3};
Circle(2) = {3, 1, 4};
Line(3) = {4, 5};
Circle(4) = {5, 1, 2};
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
Physical Curve("start", 11) = {1};
Physical Curve("outer", 12) = {2};
Physical Curve("end", 13) = {3};
Physical Curve("inner", 14) = {4};
Physical Surface("pad lining", 1) = {1};
Mesh.ElementOrder = 2;
