; Three pulses of X: there, there, and back.
G21 G90
G1 X-0.0025 F60
X-0.00125
M30
