%probe_tilted_head
; A touch with an inclined tool: G100 in the coordinates of the tool
N05 D1
N10 #TRAFO [9]
N20 #MEAS MODE[V.E.TYPE]
N30 G00 G90 X10 Y20 Z20 C=V.E.C A=V.E.A
N40 G100 X=V.E.X Z-5 C=V.E.C_END A=V.E.A_END F=V.E.FEED
N50 #MSG SYN["tool Z %f", V.A.MESS.Z]
N60 #MSG SYN["axis A %f", V.A.MEAS.ACS.VALUE.A]
N70 #MSG SYN["MOFFS Z %f", V.A.MOFFS.Z]
N80 G00 Z20
N90 #TRAFO OFF
N100 M30
