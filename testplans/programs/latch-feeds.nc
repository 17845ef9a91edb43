%latch_feeds
; As latch-study.nc, for feeds up to 3000 mm/min: the target is so far behind the workpiece that no run brakes before
; its contact. Plan columns: plc:V.E.TOUCHES, plc:V.E.FEED in mm/min, plc:V.E.CYCLE_MS of the CNC.
N10 $FOR P1 = 1, V.E.TOUCHES, 1
N20   G01 G90 Z=100 + [100 + [P1 - 1] * V.E.CYCLE_MS / V.E.TOUCHES] * V.E.FEED / 60000 F3000
N30   G100 Z94 F=V.E.FEED
N40 $ENDFOR
N50 M30
