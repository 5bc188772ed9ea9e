; Corners blended by arcs, exact ones between; held and overridden.
;: corner_um=100 500:hold 800:start 1000:override=140
G21 G90
G1 X4 Z3 F900
X2 Z8
X5 Z12
G3 X2 Z15 R5
G1 X0 Z15
G61
X3 Z-3
Z-5
G64 P0.02
X5 Z-6
X5 Z-9
G0 X0 Z0
M30
