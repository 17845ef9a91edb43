%distance_profile
; X carries the tool to V.E.X with V.E.FEED mm/min, Z keeps the distance V.E.DIST.
N010 Z[DIST_CTRL ON CONST_DIST SET_DIST=V.E.DIST]
N020 G04 0.05
N030 G90 G01 X=V.E.X F=V.E.FEED
N040 Z[DIST_CTRL OFF NO_MOVE]
N050 M30
