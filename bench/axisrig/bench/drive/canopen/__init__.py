"""What a CANopen slave does on its bus (CiA 301): PDOs, SDO, SYNC, emergencies; the nodes."""
