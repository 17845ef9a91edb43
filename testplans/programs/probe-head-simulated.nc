%probe_head_simulated
; A run in the coordinates of the tool with probes that the CNC simulates (P-AXIS-00112): 35.355 mm from (10, 20, 20) to
; (30, 5, -5) while C and A turn.
N05 D1
N10 #TRAFO [9]
N20 #MEAS [TYPE=V.E.TYPE SIMU_OFFSET=V.E.OFFSET]
N30 G00 G90 X10 Y20 Z20 C=V.E.C A=V.E.A
N40 G100 X30 Y5 Z-5 C=V.E.C_END A=V.E.A_END F=V.E.FEED
N50 #MSG SYN["tool X %f", V.A.MESS.X]
N60 #MSG SYN["tool Y %f", V.A.MESS.Y]
N70 #MSG SYN["tool Z %f", V.A.MESS.Z]
N80 #MSG SYN["axis A %f", V.A.MEAS.ACS.VALUE.A]
N90 #MSG SYN["axis Z %f", V.A.MEAS.ACS.VALUE.Z]
N100 G00 Z20
N110 #TRAFO OFF
N120 M30
