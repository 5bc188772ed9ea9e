; Arcs with R that begin and end anywhere in a quadrant, some across a quadrant's border, both senses, there and back.
G21 G90
G0 X3 Z1
G2 X1.234 Z2.6 R2.5 F900
X0.5 Z1 R1.7
G3 X2 Z-0.3 R3
X3.1 Z0.777 R1.5
G2 X2 Z-0.3 R1.5
X0.5 Z1 R3
G3 X1.234 Z2.6 R1.7
X3 Z1 R2.5
M30
