; Full circles in both senses that begin on an axis of the circle, on its diagonal and in between; the last is of 20 um.
G21 G90
G3 X0 Z0 I0 K1.5 F1500
G2 X0 Z0 I-1.5 K0
G3 X0 Z0 I1 K1
G2 X0 Z0 I-0.3 K1.1
G3 X0 Z0 I0.01 K0
M30
