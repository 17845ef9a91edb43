%fixed_stop_profidrive
; To a fixed stop with the torque limited, away from it, and the same limit as before, by the parameter P1230 of the drive.
N10 #MEAS MODE[7]
N20 #DRIVE WR SYN [AX=Z KEY=TORQUE_LIMIT VAL=V.E.LIMIT WAIT]
N40 G90 G100 Z120 F=V.E.FEED
N50 G91 G01 Z-0.5 F1000
N70 #DRIVE WR SYN [AX=Z KEY=TORQUE_LIMIT VAL=1000 WAIT]
N80 M30
