%probe_head_one_axis
; Type 2 in the coordinates of the tool: one coordinate is named, with the speed of the axis of its name (P-AXIS-00215); the F of
; the block is for later ones. Named is A, which turns the tool about its centre point, or Z.
N05 D1
N10 #TRAFO [9]
N20 #MEAS MODE[2]
N30 G00 G90 X10 Y20 Z20 C=V.E.C A=V.E.A
$IF V.E.TURNS == 1
N40 G100 A=V.E.A_END F=V.E.FEED
$ELSE
N45 G100 Z=V.E.Z F=V.E.FEED
$ENDIF
N50 #MSG SYN["tool X %f", V.A.MESS.X]
N60 #MSG SYN["tool Y %f", V.A.MESS.Y]
N70 #MSG SYN["tool Z %f", V.A.MESS.Z]
N80 #MSG SYN["axis A %f", V.A.MEAS.ACS.VALUE.A]
N90 #MSG SYN["axis Z %f", V.A.MEAS.ACS.VALUE.Z]
N100 G01 Z22
N110 #TRAFO OFF
N120 M30
