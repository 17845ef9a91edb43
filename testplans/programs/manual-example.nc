%meas_example
; FCT-C4 5; the lines that the manual leaves out are the feed before, and what is printed after the run
N10 F500
;Measuring probe tool
;with radius 2 mm
D1
N20 #MEAS MODE[1]
G0 X150 Z200
G100 Z20
N30 #MSG SYN["V.A.MEAS.PCS.VALUE.Z=%f", V.A.MEAS.PCS.VALUE.Z]
N40 #MSG SYN["V.A.MEAS.ACS.VALUE.Z=%f", V.A.MEAS.ACS.VALUE.Z]
M30
