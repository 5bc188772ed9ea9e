; Arcs of more than a quadrant, half circles, and full circles about centres off the lattice.
G21 G90
G0 X5 Z5
G2 X10 Z10 I5 K0 F800
G3 X5 Z15 I-5 K0
G2 X0 Z10 I0 K-5
G3 X-5 Z5 I-5 K0
G2 X-5 Z5 I3 K1 F1200
G3 X-5 Z5 I-2 K2 F1200
G1 X-5.3 Z5.7
M30
