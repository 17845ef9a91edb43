%distance-filters
; A sensor crosses an obstacle, distance control computes and puts nothing out (FCT-M3 4)
N10 G90
N20 Z[DIST_CTRL SET_DIST=5]
N30 Z[DIST_CTRL DRYRUN CONST_DIST]
N40 G4 1
N50 G1 X100 F6000
N60 G4 1
N70 Z[DIST_CTRL OFF]
N80 M30
