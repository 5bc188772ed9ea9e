; An override that the machine begins with, and slow short lines whose feed it changes.
;: feed_override=180 60:override=55 200:override=200
G21 G90
G1 Z0.3 F500
X0.3
Z0.6 F250
X0.6
Z0.9
X0 Z0
M30
