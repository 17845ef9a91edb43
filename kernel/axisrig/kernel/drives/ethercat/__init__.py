"""EtherCAT as it carries CiA 402: the control as master of a segment."""
