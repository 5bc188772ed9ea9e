; Dwells of a tick and longer, spindle, tool and stops between motions; nothing moves at once with them.
G21 G90
S800 M3
T0202
G4 P0.001
G1 X0.5 F300
G4 P0.25
M4 S1500
G1 Z0.5
M0
G4 P0.003
M5
M1
G0 X0 Z0
T0303 S100 M3
G1 X0.2 Z0.2
M5
M30
