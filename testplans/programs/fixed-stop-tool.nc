%fixed_stop_tool
; The tool runs down to a level stop in the coordinates of the tool. Slide and A share its force, so both drives are prepared.
N010 D1
N020 #TRAFO [9]
N030 G00 G90 X10 Y20 Z20 C=V.E.C A=V.E.A
N040 #MEAS MODE[7]
N050 #DRIVE WR SYN [AX=Z KEY=TORQUE_LIMIT VAL=V.E.LIMIT WAIT]
N060 #DRIVE WR SYN [AX=Z KEY=MON_WINDOW VAL=4294967295 WAIT]
N070 #DRIVE WR SYN [AX=A KEY=TORQUE_LIMIT VAL=V.E.LIMIT_A WAIT]
N080 #DRIVE WR SYN [AX=A KEY=MON_WINDOW VAL=4294967295 WAIT]
N150 G100 Z-5 A=V.E.A_END F=V.E.FEED
N160 #MSG SYN["V.A.MERF.C=%d", V.A.MERF.C]
N170 #MSG SYN["tool Y %f", V.A.MESS.Y]
N180 #MSG SYN["tool Z %f", V.A.MESS.Z]
N190 #MSG SYN["axis A %f", V.A.MEAS.ACS.VALUE.A]
; the run has led the axes to where they were, and the tool with them
N200 #MSG SYN["tool Y moved on %f", V.A.ABS.Y - V.A.MESS.Y]
N210 #MSG SYN["tool Z moved on %f", V.A.ABS.Z - V.A.MESS.Z]
; away from the stop
N220 G01 Z20 F1000
N230 #TRAFO OFF
N240 M30
