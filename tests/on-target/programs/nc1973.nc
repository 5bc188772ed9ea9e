; The sample of 1973: a stadium of 110 by 40 mm, in the format of its time. F1 is set, as its default takes ten minutes.
;: f1=900
N01 G91
N02 G01 X+5000 F0
N03 X+7000 F1
N04 G02 X+2000 Y0 I0 J2000
N05 X0 Y-2000 I2000 J0
N06 G01 X-7000
N07 G02 X-2000 Y0 I0 J2000
N08 X0 Y+2000 I2000 J0
N09 G01 X-5000 F0
