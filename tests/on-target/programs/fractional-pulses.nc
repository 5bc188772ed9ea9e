; Pulses of 1234.5 nm and of a 40th of 1/16 inch in 16 parts, the start off zero.
;: x.pulse_nm=1234.5 z.pulse_nm=15875/6 start=1.2345,-2.001
G21 G90
G0 X3 Z0
G1 X2 Z-3 F700
X0.001 Z-3.001
G3 X1.5 Z-1.5 R1.5 F1100
G2 X3 Z0 I1.5 K0
M30
