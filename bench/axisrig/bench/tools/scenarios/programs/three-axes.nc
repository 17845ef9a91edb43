%three_axes
; A path of X, a run of Z alone, a path of X and Z, a second run of Z at another feed; Y stands.
N10 G90 G01 X=V.E.X F3000
N20 G100 Z-1 F=V.E.FEED1
N30 G01 X0 Z=V.E.RETRACT F=V.E.FEED1
N40 G100 Z-1 F=V.E.FEED2
N50 G01 Z=V.E.RETRACT F=V.E.FEED1
N60 M30
