%fixed_stop_watched_run
; fixed-stop.nc without its writes of MON_WINDOW: FCT-C4 7.3 warns that the lag monitoring of the drive has to
; be off. The drive goes into fault (8611) while it is pressed against the stop.
N010 #MEAS MODE[7]
N030 #DRIVE WR SYN [AX=Z KEY=TORQUE_LIMIT VAL=V.E.LIMIT WAIT]
N050 G90 G100 Z=V.E.TARGET F=V.E.FEED
N060 #MSG SYN["V.A.MERF.Z=%d", V.A.MERF.Z]
N070 G91 G01 Z=V.E.AWAY F1000
N090 #DRIVE WR SYN [AX=Z KEY=TORQUE_LIMIT VAL=50000 WAIT]
N100 M30
