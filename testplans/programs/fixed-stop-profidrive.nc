%fixed_stop_profidrive
; The order of FCT-C4 7.3.2 for one axis Z with a PROFIdrive drive: its torque limit P1230 is read, changed, and
; written back behind the run; the last block reads it once more.
N010 #MEAS MODE[7]
N020 #DRIVE RD [AX=Z KEY=TORQUE_LIMIT P=P1230]
; torque limit in 0.1 % of the rated torque
N030 #DRIVE WR SYN [AX=Z KEY=TORQUE_LIMIT VAL=V.E.LIMIT WAIT]
N050 G90 G100 Z=V.E.TARGET F=V.E.FEED
N060 #MSG SYN["V.A.MERF.Z=%d", V.A.MERF.Z]
; away from the stop
N070 G91 G01 Z=V.E.AWAY F1000
N090 #DRIVE WR SYN [AX=Z KEY=TORQUE_LIMIT VAL=P1230 WAIT]
N100 #DRIVE RD [AX=Z KEY=TORQUE_LIMIT P=P2230]
N120 #MSG SYN["P1230=%d", P2230]
N140 M30
