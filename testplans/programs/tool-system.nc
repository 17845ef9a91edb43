%tool_system
; A coordinate system that is turned by 30 degrees about X, on top of the coordinates of the tool
N05 D1
N10 #TRAFO [9]
N20 #CS ON[10,20,5,30,0,0]
N30 G00 G90 X0 Y0 Z10
N40 G01 X40 Y10 Z15 C=V.E.C A=V.E.A F=V.E.FEED
N50 #MSG SYN["Z in the system %f", V.A.ABS.Z]
N60 #CS OFF
N70 #MSG SYN["Z of the tool %f", V.A.ABS.Z]
N80 #TRAFO OFF
N90 M30
