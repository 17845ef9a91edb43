%distance_chapter10
; Test of FCT-M3 10: the axis is at rest at its place, everything else is the PLC's (plc: columns, docs/plc.md).
; M50 signals that the sensor is referenced.
N010 G0 G90 Z40
N020 Z[DIST_CTRL REF]
N030 M50
N040 #TIME V.E.TIME
N050 #MSG SYN["Z=%f", V.A.ACT_POS.Z]
N060 M30
