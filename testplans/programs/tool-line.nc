%tool_line
; The tool centre point goes 70 mm along a line while the head turns; the kinematic is on to the end
N05 D1
N10 #TRAFO [9]
N20 G00 G90 X0 Y0 Z10 C0 A0
N30 G01 X60 Y30 Z30 C=V.E.C A=V.E.A F=V.E.FEED
N40 #MSG SYN["Y of the tool %f", V.A.ABS.Y]
N50 M30
