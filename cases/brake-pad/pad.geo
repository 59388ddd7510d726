// A disc-brake pad: a steel back plate with a friction lining, lengths in mm.
//   gmsh pad.geo -3 -format msh41 -bin -o pad.msh
// The disc is the plane z = 0, its axis is the z-axis; it turns towards +x at the middle of the pad.
SetFactory("OpenCASCADE");

ri = 95;  ro = 145;            // inner and outer radius of the friction ring
half = 30 * Pi / 180;          // half the angle of the pad
f = 6;                         // radius of its corners
lining = 10;  plate = 5;       // thicknesses
slot = 3;  depth = 7;          // width and depth of the slot in the lining
chamfer = 8;  rise = 3;        // length and height of the chamfers at both ends
piston = 22;  seat = 120;      // radius of the piston, distance of its axis from that of the disc

DefineConstant[ size = 7.5 ];      // length of an edge of the mesh, -setnumber size 9 for another

// Outline at z = lining: each corner is a circle that touches an arc and an end.
do = Asin(f / (ro - f));  di = Asin(f / (ri + f));
to = Sqrt((ro - f)^2 - f^2);  ti = Sqrt((ri + f)^2 - f^2);
Point(1) = {0, 0, lining};
For s In {0:1}
  a = Pi / 2 - (1 - 2 * s) * half;  w = 1 - 2 * s;
  p = 10 * (s + 1);
  Point(p + 1) = {ti * Cos(a), ti * Sin(a), lining};
  Point(p + 2) = {to * Cos(a), to * Sin(a), lining};
  Point(p + 3) = {ro * Cos(a + w * do), ro * Sin(a + w * do), lining};
  Point(p + 4) = {ri * Cos(a + w * di), ri * Sin(a + w * di), lining};
  Point(p + 5) = {(ro - f) * Cos(a + w * do), (ro - f) * Sin(a + w * do), lining};
  Point(p + 6) = {(ri + f) * Cos(a + w * di), (ri + f) * Sin(a + w * di), lining};
  Line(p + 1) = {p + 1, p + 2};
  Circle(p + 2) = {p + 2, p + 5, p + 3};
  Circle(p + 4) = {p + 4, p + 6, p + 1};
EndFor
Circle(31) = {13, 1, 23};
Circle(32) = {14, 1, 24};
Curve Loop(1) = {11, 12, 31, -22, -21, -24, -32, 14};
Plane Surface(1) = {1};
back[] = Extrude {0, 0, plate} { Surface{1}; };
front[] = Extrude {0, 0, -lining} { Surface{1}; };

// The slot and the chamfers, which follow the ends.
Box(100) = {-slot / 2, ri - 10, -1, slot, ro - ri + 20, depth + 1};
cut[] = {100};
For s In {0:1}
  a = Pi / 2 - (1 - 2 * s) * half;  w = 1 - 2 * s;
  q = 1000 * (s + 2);
  // A triangle across the end at the inner radius, drawn out along the end.
  Point(q + 1) = {(ri - 20) * Cos(a) - w * chamfer * Sin(a), (ri - 20) * Sin(a) + w * chamfer * Cos(a), 0};
  Point(q + 2) = {(ri - 20) * Cos(a) + w * chamfer * Sin(a), (ri - 20) * Sin(a) - w * chamfer * Cos(a), 2 * rise};
  Point(q + 3) = {(ri - 20) * Cos(a) + w * chamfer * Sin(a), (ri - 20) * Sin(a) - w * chamfer * Cos(a), -1};
  Point(q + 4) = {(ri - 20) * Cos(a) - w * chamfer * Sin(a), (ri - 20) * Sin(a) + w * chamfer * Cos(a), -1};
  Line(q + 1) = {q + 1, q + 2};  Line(q + 2) = {q + 2, q + 3};  Line(q + 3) = {q + 3, q + 4};  Line(q + 4) = {q + 4, q + 1};
  Curve Loop(q) = {q + 1, q + 2, q + 3, q + 4};
  Plane Surface(q) = {q};
  wedge[] = Extrude {90 * Cos(a), 90 * Sin(a), 0} { Surface{q}; };
  cut[] += wedge[1];
EndFor
pad[] = BooleanDifference{ Volume{front[1]}; Delete; }{ Volume{cut[]}; Delete; };

// The piston is imprinted on the back; both materials share their nodes.
Disk(900) = {0, seat, lining + plate, piston};
BooleanFragments{ Volume{back[1], pad[]}; Delete; }{ Surface{900}; Delete; }

e = 1e-3;  big = 1000;
Physical Volume("lining") = Volume In BoundingBox{-big, -big, -e, big, big, lining + e};
Physical Volume("plate") = Volume In BoundingBox{-big, -big, lining - e, big, big, big};
Physical Surface("contact") = Surface In BoundingBox{-big, -big, -e, big, big, e};
top[] = Surface In BoundingBox{-big, -big, lining + plate - e, big, big, big};
press[] = Surface In BoundingBox{-piston - 1, seat - piston - 1, lining + plate - e, piston + 1, seat + piston + 1, big};
Physical Surface("piston") = press[];
top[] -= press[];
Physical Surface("back") = top[];
// The end of the plate towards which the disc drags it lies on the caliper.
end[] = Surface In BoundingBox{50, 87, lining - e, 71, 121, big};
Physical Surface("abutment") = end[];

Mesh.MeshSizeMin = size;  Mesh.MeshSizeMax = size;
Mesh.ElementOrder = 2;
Mesh.HighOrderOptimize = 1;
