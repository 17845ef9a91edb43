%latch_study_stop
; Runs Z against its stop at ACS Z = 105 mm again and again, each time from a start that is a bit further away, so
; that the contacts spread evenly over a cycle of the CNC. The drive is made ready once, as in FCT-C4 7.3.2.
; Plan columns: plc:V.E.TOUCHES, plc:V.E.FEED in mm/min, plc:V.E.CYCLE_MS, plc:V.E.LIMIT of the torque in 0.1 %.
N10 #MEAS MODE[7]
N20 #DRIVE WR SYN [AX=Z KEY=TORQUE_LIMIT VAL=V.E.LIMIT WAIT]
N30 #DRIVE WR SYN [AX=Z KEY=MON_WINDOW VAL=4294967295 WAIT]
N40 $FOR P1 = 1, V.E.TOUCHES, 1
N50   G01 G90 Z=105 - [100 + [P1 - 1] * V.E.CYCLE_MS / V.E.TOUCHES] * V.E.FEED / 60000 F1000
N60   G100 Z120 F=V.E.FEED
N70 $ENDFOR
N80 M30
