;: 0:spindle=68*20000 500:hold 1500:start
; threads from the index: a pass, a second start on a taper, a hold in a thread and its pass repeated; then a feed a turn
G21 G90 G94
M3 S1000
G0 X10 Z3
G33 Z-6 K1.5
G0 X11
G0 Z3
G0 X10
G32 X12 Z-6 F1.5 Q180000
G0 X14
G95 G1 Z-10 F0.2
G94 G0 X0 Z0
M5
M2
