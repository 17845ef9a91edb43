%distance_chapter10_program
; The same commanded by the program; V.E.PART says how far it goes: 1 set position, 2 surface offset, 3 freeze,
; 4 on again, 5 off. Where the control is still on at the end 70332 reports it.
N010 G0 G90 Z40
N020 Z[DIST_CTRL REF]
N030 #TIME 0.1
N040 Z[DIST_CTRL ON SET_POS=40]
N050 #TIME 0.1
N060 $IF V.E.PART >= 2
N070   #TIME 0.4
N080 $ENDIF
N090 $IF V.E.PART >= 3
N100   Z[DIST_CTRL FREEZE]
N110   #TIME 0.4
N120 $ENDIF
N130 $IF V.E.PART >= 4
N140   Z[DIST_CTRL ON]
N150   #TIME 0.3
N160 $ENDIF
N170 #MSG SYN["Z=%f", V.A.ACT_POS.Z]
N180 $IF V.E.PART >= 5
N190   Z[DIST_CTRL WAIT OFF]
N200   #TIME 0.01                    ; the position that comes over the bus is that of two cycles ago
N210   #MSG SYN["Z=%f", V.A.ACT_POS.Z]
N220 $ENDIF
N230 M30
