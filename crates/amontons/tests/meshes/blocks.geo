// A quarter of a disc and a square below it, extruded to prisms and hexahedra. -order 1 gives P1 and Q1, -order 2 P2 and Q2.
SetFactory("Built-in");
Point(1) = {0, 0, 0}; Point(2) = {1, 0, 0}; Point(3) = {0, 1, 0};
Line(1) = {1, 2}; Circle(2) = {2, 1, 3}; Line(3) = {3, 1};
Curve Loop(1) = {1, 2, 3};
Plane Surface(1) = {1};
Point(4) = {0, -1, 0}; Point(5) = {1, -1, 0};
Line(4) = {1, 4}; Line(5) = {4, 5}; Line(6) = {5, 2};
Curve Loop(2) = {4, 5, 6, -1};
Plane Surface(2) = {2};
Transfinite Curve {1, 3, 4, 5, 6} = 3; Transfinite Curve {2} = 4;
Transfinite Surface {2}; Recombine Surface {2};
v[] = Extrude {0, 0, 1} { Surface{1, 2}; Layers{2}; Recombine; };
Physical Volume("body", 7) = {v[1], v[6]};
Physical Surface("bottom", 8) = {1, 2};
Physical Surface("round", 9) = {v[3]};
