; Pulses of 0.5 and 2 um: lines of all octants, a rapid, and arcs.
;: x.pulse_nm=500 z.pulse_nm=2000 x.max_feed=2500
G21 G90
G1 X0.4 Z1 F600
X0.5 Z2
X-0.3 Z1.7
X-1.3 Z1.6
X-1 Z-0.4
X0 Z0
G0 X1.5 Z-1
G2 X0.5 Z0 R1 F400
G3 X0.5 Z0 I0.4 K-0.2
M30
