%distance_moves
; Z moves to V.E.Z with V.E.FEED mm/min while the surface is followed: the sensor value changes with it.
N010 Z[DIST_CTRL ON SET_POS=V.E.POS]
N020 G04 0.05
N030 G90 G01 Z=V.E.Z F=V.E.FEED
N040 Z[DIST_CTRL OFF NO_MOVE]
N050 M30
