; Play taken up, expansion, reversals, quadrants; held and overridden.
;: x.backlash_um=20 z.backlash_um=35 x.backlash_distance_um=100 z.thermal_um_per_m_k=11.5 temperature_c=45
;: 500:hold 800:start 1000:override=40 1400:override=200
G21 G90
G1 X4 Z3 F900
X2 Z5
G3 X2 Z5 I-3 K4
G1 X3 Z-30
Z-25
G4 P0.05
G1 Z-28
G0 X0 Z0
M30
