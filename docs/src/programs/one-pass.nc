%
(A handle, turned from the right in one pass: face, ball, fillet, taper, fillet, shoulder, groove)
(X as diameter, Z0 at the finished face, bar of 32 mm)
N10 G7 G18 G21 G90 G94
N20 T0101 S1200 M3
N30 G0 X36 Z2
N40 Z0
N50 G1 X0 F80              (face)
N60 G3 X12 Z-22.3923 I0 K-12 F60   (ball, R12, over its equator and down to the neck)
N70 G2 X8.0438 Z-26.2745 R4         (fillet between ball and taper)
N80 G1 X18.7727 Z-77.3136 F80  (taper of 6 degrees)
N90 G2 X24.7398 Z-80 R3       (fillet to the shoulder)
N100 G1 X27
N110 G3 X30 Z-81.5 R1.5     (rounded edge)
N120 G1 Z-100
N130 G0 X34
N140 Z-88
N150 G1 X24 F40             (groove, two plunges and its floor)
N160 G4 P0.25
N170 G0 X31
N180 Z-92
N190 G1 X24
N200 Z-88
N210 G0 X36
N220 Z2
N230 M5
N240 M30
%
