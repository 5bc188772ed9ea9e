; Feed hold, and a reset before it stands.
;: 300:hold 320:reset
G21 G90
G1 X10 Z20 F3000
M30
