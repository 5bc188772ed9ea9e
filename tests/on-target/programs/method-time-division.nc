; Lines, arcs through quadrants, a full circle, held and overridden, by time-division.
;: method=time-division 400:hold 600:start 900:override=150
G21 G90
G0 X4 Z3
G1 X9 Z-4 F800
G3 X9 Z-4 I-3 K4 F600
G2 X9.5 Z-4 R3
G1 X9.51 Z-4.003
G3 X8 Z-2 R1.5 F1200
G0 X0 Z0
M30
