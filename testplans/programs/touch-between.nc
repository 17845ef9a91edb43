%touch_between
; Touches a surface again and again, from one side of it: plan columns plc:V.E.TOUCHES how often, plc:V.E.FROM
; and plc:V.E.TO between where and where in mm, plc:V.E.FEED in mm/min.
N10 $FOR P1 = 1, V.E.TOUCHES, 1
N20   G01 G90 Z=V.E.FROM F3000
N30   G100 Z=V.E.TO F=V.E.FEED
N40 $ENDFOR
N50 G01 Z=V.E.FROM F3000
N60 M30
