// A plate of 200 x 100 mm with a hole and a crack, for gmsh -2 plate.geo. Lengths in mm.
h = 10;
Mesh.ElementOrder = 2;   // edges along the hole follow the circle, not its chords
Point(1) = {0, 0, 0, h};   Point(2) = {200, 0, 0, h};   Point(3) = {200, 100, 0, h};   Point(4) = {0, 100, 0, h};
Line(1) = {1, 2};   Line(2) = {2, 3};   Line(3) = {3, 4};   Line(4) = {4, 1};

// The hole: radius 15 about (140, 50).
Point(5) = {140, 50, 0, h};
Point(6) = {155, 50, 0, h/4};   Point(7) = {140, 65, 0, h/4};   Point(8) = {125, 50, 0, h/4};   Point(9) = {140, 35, 0, h/4};
Circle(5) = {6, 5, 7};   Circle(6) = {7, 5, 8};   Circle(7) = {8, 5, 9};   Circle(8) = {9, 5, 6};

// The crack: a line inside the plate, with a fine mesh at its tips.
Point(10) = {45, 35, 0, h/40};   Point(11) = {57.5, 47.5, 0, h/4};   Point(12) = {70, 60, 0, h/40};
Line(9) = {10, 11};   Line(10) = {11, 12};

Curve Loop(1) = {1, 2, 3, 4};   Curve Loop(2) = {5, 6, 7, 8};
Plane Surface(1) = {1, 2};
Line{9, 10} In Surface{1};

// Names are what the case file refers to.
Physical Curve("bottom") = {1};   Physical Curve("right") = {2};   Physical Curve("top") = {3};   Physical Curve("left") = {4};
Physical Curve("hole:h") = {5, 6, 7, 8};
Physical Curve("crack:c") = {9, 10};
Physical Surface("plate") = {1};
