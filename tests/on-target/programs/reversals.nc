; Zigzag with slow direction pins, wide pulses and few events: edges wait, also over the border of a tick.
;: x.dir_setup_ns=150000 x.dir_hold_ns=180000 z.dir_setup_ns=40000 z.dir_hold_ns=90000
;: x.pulse_width_ns=7000 x.max_feed=3000 event_min_ns=4000 x.max_jump=20 z.max_jump=20
G21 G90
G1 X0.1 Z0.2 F1000
X0 Z0.4
X0.1 Z0.3
X0 Z0.2
X0.1
X0
X0.1
Z0
G0 X-0.05 Z-0.05
X0.05 Z0.05
M30
