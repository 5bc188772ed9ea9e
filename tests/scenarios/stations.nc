(What a way back can end at: an output, a dwell, a thread)
G21 G90
G1 X20 Z-2 F600
M3 S300
G1 Z-4
G4 P2
G1 Z-6
G33 Z-10 K1
G1 Z-14 F600
M30
