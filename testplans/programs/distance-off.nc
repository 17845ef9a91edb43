%distance_off
; Follows the surface for V.E.TIME s, then runs the offset out; the program waits until it is 0.
N010 Z[DIST_CTRL ON SET_POS=V.E.POS]
N020 G04 V.E.TIME
N030 Z[DIST_CTRL WAIT OFF]
N035 G04 0.01
N040 #MSG SYN["Z=%f", V.A.ACT_POS.Z]
N050 M30
