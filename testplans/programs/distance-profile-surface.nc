%distance_profile_surface
; X carries the tool to V.E.X with V.E.FEED mm/min, Z follows the surface that is expected at V.E.POS.
N010 Z[DIST_CTRL ON SET_POS=V.E.POS]
N020 G04 0.05
N030 G90 G01 X=V.E.X F=V.E.FEED
N040 Z[DIST_CTRL OFF NO_MOVE]
N050 M30
