%slope_weights
; One measurement run of Z with a jerk-limited slope and weights: half the acceleration, twice the
; ramp times. Whether they act on the run is the case (P-CHAN-00296).
N10 #SLOPE [TYPE=TRAPEZ]
N20 G131 = 50
N30 G133 = 200
N40 G100 G90 Z80 F=V.E.FEED
N50 M30
