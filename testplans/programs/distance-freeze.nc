%distance_freeze
; Follows the surface (V.E.POS, axis coordinates), holds the offset for V.E.TIME s, follows again.
N010 Z[DIST_CTRL ON SET_POS=V.E.POS]
N020 G04 0.1
N030 Z[DIST_CTRL FREEZE]
N040 G04 V.E.TIME
N050 Z[DIST_CTRL ON]
N060 G04 V.E.TIME
N070 Z[DIST_CTRL OFF NO_MOVE]
N080 M30
