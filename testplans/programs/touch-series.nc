%touch_series
; Touches the workpiece at ACS Z = 100 mm six times and shows each measured value.
N10 $FOR P1 = 1, 6, 1
N20   G01 G90 Z102 F3000
N30   G100 Z99 F300
N40   #MSG SYN["touch %d: Z = %.4f mm", P1, V.A.MEAS.ACS.VALUE.Z]
N50 $ENDFOR
N60 G01 Z102 F3000
N70 M30
