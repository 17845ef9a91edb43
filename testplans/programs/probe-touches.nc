%probe_touches
; Touches the workpiece at ACS Z = 100 mm again and again, for statistics over the touches.
; Plan columns: plc:V.E.TOUCHES how often, plc:V.E.FEED of the first in mm/min, plc:V.E.STEP how much
; faster each one is than the one before.
N10 $FOR P1 = 1, V.E.TOUCHES, 1
N20   G01 G90 Z102 F3000
N30   G100 Z99.5 F=V.E.FEED + [P1 - 1] * V.E.STEP
N40 $ENDFOR
N50 G01 Z101 F3000
N60 M30
