%latch_study
; Touches the workpiece at ACS Z = 100 mm again and again, each time from a start that is a bit higher, so that
; the contacts spread evenly over a cycle of the PLC. The way before the contact takes 100 ms: the feed is
; constant at every edge. Plan columns: plc:V.E.TOUCHES, plc:V.E.FEED in mm/min, plc:V.E.CYCLE_MS of the PLC.
N10 $FOR P1 = 1, V.E.TOUCHES, 1
N20   G01 G90 Z=100 + [100 + [P1 - 1] * V.E.CYCLE_MS / V.E.TOUCHES] * V.E.FEED / 60000 F3000
N30   G100 Z99 F=V.E.FEED
N40 $ENDFOR
N50 M30
