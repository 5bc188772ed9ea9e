; Feed override up and down, from 0 to 200 percent, in lines, arcs and rapids, in ramps and at speed.
;: 20:override=200 250:override=37 400:override=0 700:override=100 900:override=199 1100:override=1
;: 1400:override=150 1401:override=50 1402:override=150 1800:override=10 2000:override=120
G21 G90
G1 X3 Z4 F1200
G3 X0 Z7 R3
G2 X-2 Z5 R2 F600
G0 X5 Z0
G1 X4 Z-4 F2000
M30
