%meas_fixed_stop
; The example of FCT-C4 7.3.2 for a CANopen drive as printed, with TORQUE_LIMIT, MON_WINDOW and N080 for the
; TORQUE LIMIT, MON WINDOW and NO80 of the scan.
N010 #MEAS MODE[7]
N020 G0 Z100
; enable torque limiting
N030 #DRIVE WR SYN [AX=Z KEY=TORQUE_LIMIT VAL=10 WAIT]
; disable position lag monitoring in drive
N040 #DRIVE WR SYN [AX=Z KEY=MON_WINDOW VAL=4294967295 WAIT]
; start measurement run
N050 G100 Z1000 F100
; move away from fixed stop
N060 G01 Z100 F1000
; re-enable position lag monitoring
N070 #DRIVE WR SYN [AX=Z KEY=MON_WINDOW VAL=1048575 WAIT]
; disable torque limiting
N080 #DRIVE WR SYN [AX=Z KEY=TORQUE_LIMIT VAL=5000 WAIT]
N090 M30
