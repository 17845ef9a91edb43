%reset_result
; Asks for the value of a run whose result is gone
N10 #MSG SYN["V.A.MESS.Z=%f", V.A.MESS.Z]
N20 M30
