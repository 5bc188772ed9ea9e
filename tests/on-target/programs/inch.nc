; Inches and diameters, pulses of 1/12800 inch: decimals that no nanometre meets.
;: x.pulse_nm=15875/8 z.pulse_nm=15875/8
G20 G90 G7
G0 X0.3 Z0.05
G1 X0.25 Z-0.033 F30
G2 X0.35 Z-0.083 R0.05
G1 U-0.1 W0.0333
M30
