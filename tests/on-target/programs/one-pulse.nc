; One pulse of Z, and a motion of none.
G21 G90
G1 Z-0.0025 F100
Z-0.0026
M30
