(A stepped shaft whose corners are left by at most 0.3 mm)
G7
G0 X18 Z2
G64 P0.3
G1 Z-8 F1200
X24 Z-14
G2 X28 Z-16 R2
G1 Z-22
G61
G0 X36
M30
