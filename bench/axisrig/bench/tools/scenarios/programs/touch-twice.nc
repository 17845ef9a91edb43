%touch_twice
; Two runs of one place at two feeds, whatever gives the signal.
N10 G90 G100 Z98 F=V.E.FEED1
N20 G01 Z=V.E.BACK F1200
N30 G100 Z98 F=V.E.FEED2
N40 G01 Z=V.E.BACK F1200
N50 M30
