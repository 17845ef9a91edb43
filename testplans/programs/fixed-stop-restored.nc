%fixed_stop_restored
; As fixed-stop.nc, but the torque limit is restored while the axis is at rest at the stop: after the relaxing
; motion nothing may move and no force may rise. Without it the axis would press with the new limit.
N010 #MEAS MODE[7]
N030 #DRIVE WR SYN [AX=Z KEY=TORQUE_LIMIT VAL=V.E.LIMIT WAIT]
N040 #DRIVE WR SYN [AX=Z KEY=MON_WINDOW VAL=4294967295 WAIT]
N050 G90 G100 Z=V.E.TARGET F=V.E.FEED
N060 #MSG SYN["V.A.MERF.Z=%d", V.A.MERF.Z]
; the torque limit as before, at the stop
N070 #DRIVE WR SYN [AX=Z KEY=TORQUE_LIMIT VAL=50000 WAIT]
N080 G04 0.2
; away from the stop
N090 G91 G01 Z=V.E.AWAY F1000
N100 #DRIVE WR SYN [AX=Z KEY=MON_WINDOW VAL=1048575 WAIT]
N110 M30
