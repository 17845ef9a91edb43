%drive_functions
; The #DRIVE lines of FCT-C4 section 7.3.2 around a plain move: torque limit of 10 %, lag monitoring of
; the drive off, and both as before. A fixed stop in the way of N050 (plant:z.stop_position_mm) leaves the
; axis behind by more than the window of 10 mm: the drive would go into fault (8611) without N040.
N010 #DRIVE RD [AX=Z KEY=TORQUE_LIMIT P=V.P.TORQUE]
N012 #DRIVE RD [AX=Z KEY=MON_WINDOW P=V.P.WINDOW]
N014 #MSG SYN["torque before=%d", V.P.TORQUE]
N016 #MSG SYN["window before=%.0f", V.P.WINDOW]
N020 G0 G90 Z100
; enable torque limiting
N030 #DRIVE WR SYN [AX=Z KEY=TORQUE_LIMIT VAL=10 WAIT]
; disable position lag monitoring in the drive
N040 #DRIVE WR SYN [AX=Z KEY=MON_WINDOW VAL=4294967295 WAIT]
N042 #DRIVE RD [AX=Z KEY=TORQUE_LIMIT P=V.P.TORQUE]
N044 #DRIVE RD [AX=Z KEY=MON_WINDOW P=V.P.WINDOW]
N046 #MSG SYN["torque=%d", V.P.TORQUE]
N048 #MSG SYN["window=%.0f", V.P.WINDOW]
N050 G01 Z120 F600
N060 G01 Z100 F1000
; enable position lag monitoring again
N070 #DRIVE WR SYN [AX=Z KEY=MON_WINDOW VAL=1048575 WAIT]
; disable torque limiting
N080 #DRIVE WR SYN [AX=Z KEY=TORQUE_LIMIT VAL=5000 WAIT]
N082 #DRIVE RD [AX=Z KEY=TORQUE_LIMIT P=V.P.TORQUE]
N084 #DRIVE RD [AX=Z KEY=MON_WINDOW P=V.P.WINDOW]
N086 #MSG SYN["torque after=%d", V.P.TORQUE]
N088 #MSG SYN["window after=%.0f", V.P.WINDOW]
N090 M30
