;: handwheels=true accel=sine x.backlash_um=20 z.backlash_um=30 80:wheel-x=2*300 200:wheel-z=3*100 900:wheel-z=-3*100 700:rapid=40
; the same under an S law with play taken up
G21 G90
G1 X5 Z-2 F1500
G3 X1 Z-6 R4
G1 Z-9
G0 X0 Z0
M2
