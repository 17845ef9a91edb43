%DIST_3  ; FCT-M3 6: off without motion; the next block goes to its true target
N10 Z[DIST_CTRL ON SET_POS=50]
N20 G04 0.5
N30 Z[DIST_CTRL OFF NO_MOVE]
N35 G04 0.01  ; so that the axis would show a motion
N40 #MSG SYN["Z=%f", V.A.ACT_POS.Z]
N50 G0 Z100
N60 G04 0.1
N70 #MSG SYN["Z=%f", V.A.ACT_POS.Z]
N999 M30
