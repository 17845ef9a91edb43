"""The PLC side of a rig: what it does in a run, written in the columns `plc:` of a plan."""
