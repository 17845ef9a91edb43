%overrides
; A path and a run with ramps of the acceleration, while the override moves.
N10 G90 G01 Z=V.E.Z F3600
N20 G100 Z90 F=V.E.FEED
N30 G01 Z101 F3600
N40 M30
