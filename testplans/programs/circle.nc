%circle
; A full circle of 50 mm radius around X0 Y0, clockwise, at 2 m/min.
N10 G01 G90 G17 X0 Y50 F1000 G60
N20 G02 X0 Y50 I0 J-50 F2000
N30 #MSG SYN["X=%f Y=%f", V.A.ABS.X, V.A.ABS.Y]
N40 M30
