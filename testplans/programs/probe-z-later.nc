%probe_z_later
; As probe-z.nc, with a pause of V.E.PAUSE seconds between approach and run.
N10 G01 G90 Z110.374 F3000
N15 G04 V.E.PAUSE
N20 G100 Z80 F=V.E.FEED
N30 #MSG SYN["V.A.MERF.Z=%d", V.A.MERF.Z]
N40 G01 Z120 F3000
N50 M30
