%fixed_stop_plc
; Run to a fixed stop whose limits in the drive are the PLC's business (plc: columns, docs/plc.md): M50 asks
; for them, M51 for what was before. The PLC acknowledges M50 when the drive has taken them.
N010 #MEAS MODE[7]
N020 G0 G90 Z100
N030 M50
N040 G100 Z150 F600
N050 #MSG SYN["found=%d", V.A.MERF.Z]
N060 G1 Z110 F600
N070 M51
N080 #DRIVE RD [AX=Z KEY=TORQUE_LIMIT P=V.P.TORQUE]
N090 #MSG SYN["limit=%d", V.P.TORQUE]
N100 M30
