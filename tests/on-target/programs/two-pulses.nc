; One pulse of each axis at once, by a rapid.
G21 G90
G0 X0.00125 Z-0.0025
M30
