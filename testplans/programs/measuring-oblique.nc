%measuring_oblique
; A ball of 2 mm meets the workpiece on an oblique run: 0.6 in X, -0.8 in Z
N05 #MEAS MODE[1]
N10 D1
N20 G01 G90 X0 Y0 Z150 F3000
N30 G100 X60 Z70 F600
N40 #MSG SYN["centre of the ball on the axis %f", V.A.MEAS.ACS.VALUE.Z]
N50 #MSG SYN["point of the ball that lies ahead, Z %f", V.A.MEAS.PCS.VALUE.Z]
N60 #MSG SYN["the same in X, from the centre %f", V.A.MEAS.PCS.VALUE.X - V.A.MEAS.ACS.VALUE.X]
N70 G01 Z150 F3000
N80 M30
