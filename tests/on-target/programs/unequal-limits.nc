; Rapids and feeds with a slow cross slide and a fast carriage, of unequal acceleration and start-stop speed.
;: x.max_feed=1200 z.max_feed=6000 x.max_accel=80 z.max_accel=1500 x.max_jump=0.5 z.max_jump=6
G21 G90
G0 X4 Z20
X0
Z0
X-1 Z-8
G1 X1 Z0 F1500
G2 X3 Z2 R2
G0 X0 Z0
M30
