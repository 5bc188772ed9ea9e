;: handwheels=true 60:wheel-x=1*200 100:wheel-z=-1*150 400:wheel-x=-1*200 500:hold 700:wheel-x=4*5 900:start 1100:override=60 1500:null-offset
; the handwheels beside a program, in a hold, and their offset nulled
G21 G90
G1 X5 Z-2 F900
G2 X9 Z-6 R4
G1 Z-12
G0 X0 Z0
M2
