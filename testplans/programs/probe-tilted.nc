%probe_tilted
; The plane of a tilted system, touched along its own Z; a probe that does not turn with it
N10 #MEAS MODE[1]
N20 D2
N30 #CS ON[0,0,100,0,15,0]
N40 G90 G1 X20 Y10 Z60 F3000
N50 G100 Z-20 F300
N60 #MSG SYN["top of the tilted workpiece %f", V.A.MEAS.PCS.VALUE.Z]
N70 G1 Z60 F3000
N80 #CS OFF
N90 M30
