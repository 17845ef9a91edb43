%distance_waits
; The surface is followed while the program waits: a dwell time, M51 and V.E.READY for the PLC side, a path in feedhold.
N010 Z[DIST_CTRL ON SET_POS=V.E.POS]
N020 G04 V.E.TIME
N022 M51
N024 #WAIT FOR V.E.READY == 1
N030 G90 G01 X=V.E.X F=V.E.FEED
N040 G04 V.E.TIME
N050 Z[DIST_CTRL OFF NO_MOVE]
N060 M30
