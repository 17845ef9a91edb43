%tool_turns
; The tool turns about its centre point, which stays where it is
N05 D1
N10 #KIN ID[9]
N20 #TRAFO ON
N30 G00 G90 X10 Y20 Z5
N40 G01 C=V.E.C A=V.E.A F=V.E.FEED
N50 G01 C0 A0
N60 #MSG SYN["at %f %f %f", V.A.ABS.X, V.A.ABS.Y, V.A.ABS.Z]
N70 #TRAFO OFF
N80 #MSG SYN["Z of the axis %f", V.A.ACS.ABS.Z]
N90 M30
