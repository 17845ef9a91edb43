%measuring_types
; One measurement run of Z in the type and at the feed that come from outside. Type 2 has the speed
; of its axis list instead of F; type 5 has measuring-jump.nc, type 3 with G106 measuring-goes-on.nc.
N05 #MEAS MODE[V.E.TYPE]
N10 G01 G90 Z110.374 F3000
N20 G100 Z=V.E.TARGET F=V.E.FEED
N30 #MSG SYN["V.A.MERF.Z=%d", V.A.MERF.Z]
N40 #MSG SYN["V.A.ABS.Z=%f", V.A.ABS.Z]
N50 G01 Z120 F3000
N60 M30
