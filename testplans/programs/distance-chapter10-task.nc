%distance_chapter10_task
; Test of FCT-M3 10 with a PLC program (plc/distance_control.py): the axis is at rest at its place. V.E.REFERENCED signals that
; the sensor is referenced; what the control unit shows comes back as V.E. variables.
N010 G0 G90 Z40
N020 Z[DIST_CTRL REF]
N030 V.E.REFERENCED = 1
N040 #TIME V.E.TIME
N050 #MSG SYN["Z=%f", V.A.ACT_POS.Z]
N060 #MSG SYN["surface=%f offset=%f state=%f source=%f", V.E.SURFACE, V.E.OFFSET, V.E.STATE, V.E.SOURCE]
N070 M30
