%probe_crash
; A positioning block that runs the probe into the workpiece: nothing watches for the signal.
N10 G01 G90 Z110 F3000
N20 Z=V.E.TARGET F=V.E.FEED
N30 M30
