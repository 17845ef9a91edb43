%reset_distance
; Started after a reset: where the axis is, with the offset that was left in its position, distance
; control on again, off until its offset has run out.
N10 #MSG SYN["V.A.ACT_POS.Z=%f", V.A.ACT_POS.Z]
N20 G1 G90 Z36 F3000
N30 Z[DIST_CTRL ON SET_POS=30]
N40 G04 0.2
N50 Z[DIST_CTRL OFF WAIT]
N60 G60 G1 Z37 F3000
N70 #MSG SYN["V.A.ACT_POS.Z=%f", V.A.ACT_POS.Z]
N80 M30
