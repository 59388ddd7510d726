// Half section of a dry clutch, x the radius and y along the axis, in m: a steel core with two bonded linings between two steel plates.
// Each body has nodes of its own, so that the sides of a pair need not match. Heat penetrates a lining by 74 µm in a time step: its cells are finer at both
// faces.
//
//     gmsh -2 clutch-plates.geo -o clutch-plates.msh

inner = 90e-3;  outer = 120e-3;

// A plate of revolution from y = low to y = high, with cells along the radius and across it, which at both faces are finer for a bump below one.
Macro Plate
  p = newp;
  Point(p) = {inner, low, 0};  Point(p + 1) = {outer, low, 0};  Point(p + 2) = {outer, high, 0};  Point(p + 3) = {inner, high, 0};
  l = newl;
  Line(l) = {p, p + 1};  Line(l + 1) = {p + 1, p + 2};  Line(l + 2) = {p + 3, p + 2};  Line(l + 3) = {p, p + 3};
  Transfinite Curve {l, l + 2} = along + 1;
  Transfinite Curve {l + 1, l + 3} = across + 1 Using Bump bump;
  s = news;
  Curve Loop(s) = {l, l + 1, -(l + 2), -(l + 3)};
  Plane Surface(s) = {s};
  Transfinite Surface {s};
  Recombine Surface {s};
Return

low = 0;      high = 5e-3;   along = 45;  across = 12;  bump = 0.5;  Call Plate;
Physical Surface("counter_plate") = {s};  Physical Curve("counter_plate_bottom") = {l};
low = 5e-3;   high = 8e-3;   along = 54;  across = 20;  bump = 0.35;  Call Plate;
Physical Surface("lining_1") = {s};  Physical Curve("lining_1_top") = {l + 2};
low = 8e-3;   high = 10e-3;  along = 45;  across = 4;   bump = 1;  Call Plate;
Physical Surface("core") = {s};  Physical Curve("core_bottom") = {l};  Physical Curve("core_top") = {l + 2};
low = 10e-3;  high = 13e-3;  along = 54;  across = 20;  bump = 0.35;  Call Plate;
Physical Surface("lining_2") = {s};  Physical Curve("lining_2_bottom") = {l};
low = 13e-3;  high = 17e-3;  along = 45;  across = 10;  bump = 0.5;  Call Plate;
Physical Surface("pressure_plate") = {s};  Physical Curve("pressure_plate_top") = {l + 2};
