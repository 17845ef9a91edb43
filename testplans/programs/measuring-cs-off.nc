%measuring_cs_off
; A measurement offset across #CS OFF: what is included in a system ends with it, and the value of a
; run in the system is a number that may be included afterwards (docs/ambiguities.md)
N05 #MEAS MODE[1]
N10 #CS ON[0,0,75,0,15,0]
N20 G01 G90 X150 Z100 F3000
N30 G100 Z-10 F1000
N40 #MSG SYN["in the system, V.A.MOFFS.Z=%f", V.A.MOFFS.Z]
N50 G101 Z1
N60 #MSG SYN["in the system, V.A.MEIN.Z=%f", V.A.MEIN.Z]
N70 G01 Z100 F3000
N80 #CS OFF
N90 #MSG SYN["after it, V.A.MEIN.Z=%f", V.A.MEIN.Z]
N100 #MSG SYN["after it, V.A.MOFFS.Z=%f", V.A.MOFFS.Z]
N110 G101 Z1
N120 #MSG SYN["included again, V.A.MEIN.Z=%f", V.A.MEIN.Z]
N130 G01 Z150 F3000
N140 #MSG SYN["V.A.ABS.Z=%f", V.A.ABS.Z]
N150 M30
