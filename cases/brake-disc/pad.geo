// A disc-brake pad as a sector of a ring, hexahedra in layers that are thinnest at the disc; lengths in mm.
//   gmsh pad.geo -3 -format msh41 -bin -o pad.msh
// The disc is the plane z = 0, its axis is the z-axis; at the middle of the pad, on the y-axis, it turns towards +x.
ri = 95;  ro = 145;                // inner and outer radius of the friction ring
half = 30 * Pi / 180;              // half the angle of the pad
press = 12 * Pi / 180;             // half the angle of the part that the piston presses
lining = 10;  plate = 5;           // thicknesses

DefineConstant[ radial = 5, around = 4 ];   // cells across the ring, and along each of the three parts of the sector

Point(1) = {0, 0, 0};
For s In {0:3}
  a = Pi / 2 + (s == 0 ? half : (s == 1 ? press : (s == 2 ? -press : -half)));
  Point(10 + s) = {ri * Cos(a), ri * Sin(a), 0};
  Point(20 + s) = {ro * Cos(a), ro * Sin(a), 0};
  Line(30 + s) = {10 + s, 20 + s};
  Transfinite Curve{30 + s} = radial + 1;
EndFor
For s In {0:2}
  Circle(40 + s) = {10 + s, 1, 11 + s};
  Circle(50 + s) = {20 + s, 1, 21 + s};
  Transfinite Curve{40 + s, 50 + s} = around + 1;
  Curve Loop(s + 1) = {30 + s, 50 + s, -(31 + s), -(40 + s)};
  Plane Surface(s + 1) = {s + 1};
  Transfinite Surface{s + 1};
  Recombine Surface{s + 1};
EndFor
// The lining, from the disc on in layers of 0.5, 1, 2, 3 and 3.5 mm, then the plate.
For s In {0:2}
  body[] = Extrude {0, 0, lining} { Surface{s + 1}; Layers{ {1, 1, 1, 1, 1}, {0.05, 0.15, 0.35, 0.65, 1} }; Recombine; };
  linings[] += body[1];
  body[] = Extrude {0, 0, plate} { Surface{body[0]}; Layers{ {1}, {1} }; Recombine; };
  plates[] += body[1];
  backs[] += body[0];
EndFor

Physical Volume("lining") = linings[];
Physical Volume("plate") = plates[];
Physical Surface("contact") = {1, 2, 3};
Physical Surface("piston") = {backs[1]};
Physical Surface("back") = {backs[0], backs[2]};
// The end of the plate towards which the disc drags it lies on the caliper.
e = 1e-3;
end[] = Surface In BoundingBox{ri / 2 - e, 0, lining - e, ro / 2 + e, ro, lining + plate + e};
Physical Surface("abutment") = end[];

Mesh.ElementOrder = 2;
