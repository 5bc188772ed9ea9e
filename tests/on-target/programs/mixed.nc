; A rapid, lines, arcs with R and a programmed stop.
G21 G90 G94
G0 X10 Z5
G1 X12 Z8 F600
G2 X16 Z4 R6
G3 X10 Z0 R6
G1 X3 F1000
M0
G1 Z-3 F300
