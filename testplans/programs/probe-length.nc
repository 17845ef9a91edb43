%probe_length
; A probe of 50 mm and a ball of 2 mm; D0 takes it off, inches show the same place
N10 #MEAS MODE[1]
N20 D2
N30 G90 G1 X0 Y0 Z180 F3000
N40 G100 Z20 F300
N50 #MSG SYN["surface %f", V.A.MEAS.PCS.VALUE.Z]
N60 #MSG SYN["axis %f", V.A.MEAS.ACS.VALUE.Z]
N70 G70
N80 #MSG SYN["surface in inches %.9f", V.A.MEAS.PCS.VALUE.Z]
N90 G71 D0
N100 G1 Z200 F3000
N110 #MSG SYN["without a tool the axis is at %f", V.A.ABS.Z]
N120 M30
