; Quarter arcs in each quadrant, both senses, with I and K.
G21 G90
G0 X4 Z0
G3 X2 Z-2 I-2 K0 F1200
X0 Z0 I0 K2
X2 Z2 I2 K0
X4 Z0 I0 K-2
G2 X2 Z2 I-2 K0
X0 Z0 I0 K-2
X2 Z-2 I2 K0
X4 Z0 I0 K2
M30
