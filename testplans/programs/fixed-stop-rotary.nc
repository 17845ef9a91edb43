%fixed_stop_rotary
; A measurement run of the rotary table C to a fixed stop, in degrees; the order is that of fixed-stop.nc.
N010 #MEAS MODE[7]
; torque limit in 0.1 % of the rated torque
N030 #DRIVE WR SYN [AX=C KEY=TORQUE_LIMIT VAL=V.E.LIMIT WAIT]
N040 #DRIVE WR SYN [AX=C KEY=MON_WINDOW VAL=4294967295 WAIT]
N050 G90 G100 C=V.E.TARGET F=V.E.FEED
N060 #MSG SYN["V.A.MERF.C=%d", V.A.MERF.C]
; away from the stop
N070 G91 G01 C=V.E.AWAY F1000
N080 #DRIVE WR SYN [AX=C KEY=MON_WINDOW VAL=1048575 WAIT]
N090 #DRIVE WR SYN [AX=C KEY=TORQUE_LIMIT VAL=50000 WAIT]
N100 M30
