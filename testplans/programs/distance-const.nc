%distance_const
; Keeps a constant distance for a while: V.E.DIST in mm, V.E.TIME in s. Nothing is programmed meanwhile.
N010 Z[DIST_CTRL ON CONST_DIST SET_DIST=V.E.DIST]
N020 G04 V.E.TIME
N030 Z[DIST_CTRL OFF NO_MOVE]
N040 M30
