; Under the sine law, corners, arcs, short lines, held and overridden.
;: accel=sine 500:hold 800:start 1000:override=40 1400:override=200 1800:override=100
G21 G90
G1 X4 Z3 F1500
X6 Z-4
G3 X6 Z-4 I-3 K4
G1 X6.05 Z-4.02
X6.1 Z-4.05
X6.15 Z-4.09
X9 Z-9
G4 P0.05
G0 X0 Z0
M30
