; Feed hold and cycle start: in a ramp, at speed, while it brakes, over the corner of a line and an arc, in a rapid and
; before anything moves.
;: 0:hold 100:start 150:hold 151:start 300:hold 310:start 420:hold 900:start 1200:hold 1800:start 2400:hold 2500:start
G21 G90
G1 X3 Z4 F900
G3 X0 Z7 R3
G1 X-2
G0 X5 Z0
G1 X4 Z-1
M30
