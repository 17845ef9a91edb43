%override_rapid
; One rapid motion of 100 mm
N10 G0 G90 Z30
N20 M30
