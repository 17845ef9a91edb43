%fixed_stop_sercos
; The order of FCT-C4 7.3.1 for one axis Z: torque limit S-0-0092 and lag monitoring S-0-0159 of the drive are read,
; changed, and written back behind the run; the last block reads both once more.
N010 #MEAS MODE[7]
N020 #IDENT RD [AX=Z ID=S-0-0092 P=P1092 TYP=2 DEC=0 SERC]
N025 #IDENT RD [AX=Z ID=S-0-0159 P=P1159 TYP=4 DEC=0 SERC]
; torque limit in 0.1 % of the rated torque
N030 #IDENT WR SYN [AX=Z ID=S-0-0092 VAL=V.E.LIMIT TYP=2 DEC=0 SERC]
; lag monitoring in the drive off: V.E.WATCH = 0
N040 #IDENT WR SYN [AX=Z ID=S-0-0159 VAL=V.E.WATCH TYP=4 DEC=0 SERC]
N050 G90 G100 Z=V.E.TARGET F=V.E.FEED
N060 #MSG SYN["V.A.MERF.Z=%d", V.A.MERF.Z]
; away from the stop
N070 G91 G01 Z=V.E.AWAY F1000
N080 #IDENT WR SYN [AX=Z ID=S-0-0159 VAL=P1159 TYP=4 DEC=0 SERC]
N090 #IDENT WR SYN [AX=Z ID=S-0-0092 VAL=P1092 TYP=2 DEC=0 SERC]
N100 #IDENT RD [AX=Z ID=S-0-0092 P=P2092 TYP=2 DEC=0 SERC]
N110 #IDENT RD [AX=Z ID=S-0-0159 P=P2159 TYP=4 DEC=0 SERC]
N120 #MSG SYN["S-0-0092=%d", P2092]
N130 #MSG SYN["S-0-0159=%d", P2159]
N140 M30
