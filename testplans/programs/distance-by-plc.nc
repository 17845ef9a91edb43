%distance_by_plc
; The program only waits for V.E.TIME s: distance control is commanded by the PLC side.
N010 G04 V.E.TIME
N020 M30
