; Long arcs with fractional pulses, off the start, held and overridden.
;: x.pulse_nm=15875/8 z.pulse_nm=15875/16 start=1,2 900:hold 1900:start 300:override=180 2500:override=20
;: 3200:override=140
G21 G90
G0 X5 Z5
G2 X10 Z10 I5 K0 F800
G3 X5 Z15 I-5 K0
G2 X5 Z15 I-2 K1 F1200
M30
