%latch_study_xz
; As latch-study.nc, oblique: -0.6 in X, -0.8 in Z, for the value of an axis whose own unit has no signal.
; Plan columns: plc:V.E.TOUCHES, plc:V.E.FEED of the path in mm/min, plc:V.E.CYCLE_MS of the PLC.
N10 $FOR P1 = 1, V.E.TOUCHES, 1
N20   P2 = [100 + [P1 - 1] * V.E.CYCLE_MS / V.E.TOUCHES] * V.E.FEED / 60000
N30   G01 G90 X=0.6 * P2 Z=100 + 0.8 * P2 F3000
N40   G100 X-0.75 Z99 F=V.E.FEED
N50 $ENDFOR
N60 M30
