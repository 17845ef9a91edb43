%fixed_stop_speed_drive
; To a fixed stop with a drive that only takes a speed: no word limits its torque, so that the limit of its amplifier counts.
; Plan columns: plc:V.E.TARGET, plc:V.E.AWAY in mm, plc:V.E.FEED in mm/min.
N010 #MEAS MODE[7]
N050 G90 G100 Z=V.E.TARGET F=V.E.FEED
N060 #MSG SYN["V.A.MERF.Z=%d", V.A.MERF.Z]
; away from the stop
N070 G91 G01 Z=V.E.AWAY F1000
N140 M30
