%fixed_stop
; A measurement run of Z to a fixed stop in the order of FCT-C4 7.3.2: torque limited, lag monitoring of the
; drive off, run, away from the stop with the torque still limited, then both as before.
N010 #MEAS MODE[7]
; torque limit in 0.1 % of the rated torque
N030 #DRIVE WR SYN [AX=Z KEY=TORQUE_LIMIT VAL=V.E.LIMIT WAIT]
; lag monitoring in the drive off
N040 #DRIVE WR SYN [AX=Z KEY=MON_WINDOW VAL=4294967295 WAIT]
N050 G90 G100 Z=V.E.TARGET F=V.E.FEED
N060 #MSG SYN["V.A.MERF.Z=%d", V.A.MERF.Z]
; away from the stop
N070 G91 G01 Z=V.E.AWAY F1000
N080 #DRIVE WR SYN [AX=Z KEY=MON_WINDOW VAL=1048575 WAIT]
N090 #DRIVE WR SYN [AX=Z KEY=TORQUE_LIMIT VAL=50000 WAIT]
N100 M30
