%override_distance
; Follows a surface that is 0.4 mm higher than SET_POS, for V.E.TIME s
N10 Z[DIST_CTRL ON SET_POS=29.6]
N20 G04 V.E.TIME
N30 Z[DIST_CTRL OFF NO_MOVE]
N40 M30
