%homing_end
; nothing comes after homing: the axis has to settle, for no longer than its settling time from the end of homing on
N10 G74 Z1
N90 M30
