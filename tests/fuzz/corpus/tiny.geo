lc = 0.4;
Point(1) = {0, 0, 0, lc}; Point(2) = {2, 0, 0, lc}; Point(3) = {2, 1, 0, lc}; Point(4) = {0, 1, 0, lc};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Point(5) = {1, 0.5, 0, lc}; Point(6) = {1.2, 0.5, 0, lc}; Point(7) = {0.8, 0.5, 0, lc};
Circle(5) = {6, 5, 7}; Circle(6) = {7, 5, 6};
Curve Loop(1) = {1, 2, 3, 4}; Curve Loop(2) = {5, 6};
Plane Surface(1) = {1, 2};
Physical Curve("left") = {4}; Physical Curve("right") = {2}; Physical Surface("body") = {1};
