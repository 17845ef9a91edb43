%older_parameters
; One run of Z from 105 to 98 mm at 600 mm/min, with the source, input and edge that the list of the axis has.
N10 G01 G90 Z105 F3000
N20 G100 Z98 F600
N30 #MSG SYN["V.A.MERF.Z=%d", V.A.MERF.Z]
N40 #MSG SYN["V.A.MESS.Z=%f", V.A.MESS.Z]
N50 M30
