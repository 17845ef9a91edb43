%touch_often
; Touches the workpiece at ACS Z = 100 mm again and again, from a height that the plan gives.
; Plan columns: plc:V.E.TOUCHES how often, plc:V.E.ABOVE from where in mm, plc:V.E.FEED in mm/min.
N10 $FOR P1 = 1, V.E.TOUCHES, 1
N20   G01 G90 Z=V.E.ABOVE F3000
N30   G100 Z99.5 F=V.E.FEED
N40 $ENDFOR
N50 G01 Z=V.E.ABOVE F3000
N60 M30
