%probe_phases
; Touches the workpiece again and again, each time from a start that is V.E.SHIFT mm higher, so that the
; contacts spread evenly over a cycle of the PLC. Plan columns: plc:V.E.TOUCHES, plc:V.E.FEED in mm/min,
; plc:V.E.SHIFT = feed times cycle over the number of touches.
N10 $FOR P1 = 1, V.E.TOUCHES, 1
N20   G01 G90 Z=101 + [P1 - 1] * V.E.SHIFT F3000
N30   G100 Z99 F=V.E.FEED
N40 $ENDFOR
N50 G01 Z101 F3000
N60 M30
