%drive_functions
; The #DRIVE lines of FCT-C4 section 7.3.2 around a plain move: torque limit of 10 %, lag monitoring of
; the drive off, and both as before. The measurement run to the fixed stop itself is not there yet.
N020 G0 G90 Z100
; enable torque limiting
N030 #DRIVE WR SYN [AX=Z KEY=TORQUE_LIMIT VAL=10 WAIT]
; disable position lag monitoring in the drive
N040 #DRIVE WR SYN [AX=Z KEY=MON_WINDOW VAL=4294967295 WAIT]
N042 #DRIVE RD [AX=Z KEY=TORQUE_LIMIT P=V.P.TORQUE]
N044 #DRIVE RD [AX=Z KEY=MON_WINDOW P=V.P.WINDOW]
N046 #MSG SYN["torque=%d", V.P.TORQUE]
N048 #MSG SYN["window=%.0f", V.P.WINDOW]
N050 G01 Z110 F100
N060 G01 Z100 F1000
; enable position lag monitoring again
N070 #DRIVE WR SYN [AX=Z KEY=MON_WINDOW VAL=1048575 WAIT]
; disable torque limiting
N080 #DRIVE WR SYN [AX=Z KEY=TORQUE_LIMIT VAL=5000 WAIT]
N090 M30
