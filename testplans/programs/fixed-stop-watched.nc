%fixed_stop_watched
; drive-functions.nc without its writes of MON_WINDOW (N040, N070): the lag stays monitored. With a fixed
; stop in the way of N050 the drive goes into fault (8611), ID 900005.
N010 #DRIVE RD [AX=Z KEY=TORQUE_LIMIT P=V.P.TORQUE]
N012 #DRIVE RD [AX=Z KEY=MON_WINDOW P=V.P.WINDOW]
N014 #MSG SYN["torque before=%d", V.P.TORQUE]
N016 #MSG SYN["window before=%.0f", V.P.WINDOW]
N020 G0 G90 Z100
; enable torque limiting
N030 #DRIVE WR SYN [AX=Z KEY=TORQUE_LIMIT VAL=10 WAIT]
N042 #DRIVE RD [AX=Z KEY=TORQUE_LIMIT P=V.P.TORQUE]
N044 #DRIVE RD [AX=Z KEY=MON_WINDOW P=V.P.WINDOW]
N046 #MSG SYN["torque=%d", V.P.TORQUE]
N048 #MSG SYN["window=%.0f", V.P.WINDOW]
N050 G01 Z120 F600
N060 G01 Z100 F1000
; disable torque limiting
N080 #DRIVE WR SYN [AX=Z KEY=TORQUE_LIMIT VAL=5000 WAIT]
N082 #DRIVE RD [AX=Z KEY=TORQUE_LIMIT P=V.P.TORQUE]
N084 #DRIVE RD [AX=Z KEY=MON_WINDOW P=V.P.WINDOW]
N086 #MSG SYN["torque after=%d", V.P.TORQUE]
N088 #MSG SYN["window after=%.0f", V.P.WINDOW]
N090 M30
