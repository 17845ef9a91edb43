%distance_surface
; Follows the surface that is expected at V.E.POS (mm, axis coordinates) for V.E.TIME (s).
N010 Z[DIST_CTRL ON SET_POS=V.E.POS]
N020 G04 V.E.TIME
N030 Z[DIST_CTRL OFF NO_MOVE]
N040 M30
