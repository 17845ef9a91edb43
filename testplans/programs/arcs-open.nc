%arcs-open
; Two arcs of a quarter turn whose ends are 4 um farther from the centre than their begins: G165 moves the
; centre, G164 takes the arc as it is (within P-CHAN-00171 and 00172).
N10 G01 G90 G17 X0 Y50 F1000 G60
N20 G165 G02 X50.004 Y0 I0 J-50 F2000
N30 #MSG SYN["X=%f", V.A.ABS.X]
N40 G164 G02 X0 Y-50.008 I-50.004 J0
N50 #MSG SYN["Y=%f", V.A.ABS.Y]
N60 M30
