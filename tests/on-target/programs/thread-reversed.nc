;: 0:spindle=68*500 500:spindle=-68*2000
; the spindle turns round in a thread: alarm 211, the tool retreats in step
G21 G90 G94
M3 S1000
G0 X10 Z3
G33 Z-6 K1.5
G0 X11
M2
