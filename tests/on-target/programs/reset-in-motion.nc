; Reset at speed in an arc: it brakes within the limits and leaves the rest undone.
;: 400:reset
G21 G90
G1 X1 Z1 F1500
G3 X-8 Z10 R9
G1 X20
M30
