; One pulse in many ticks: 2 mm/min, a pulse of X every 37.5 ms; then the slowest feed of a few pulses of both axes.
G21 G90
G1 X0.02 F2
X0.03 Z0.007 F0.9
G2 X0.04 Z0.007 R0.005 F3
M30
