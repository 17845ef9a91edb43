"""The rig file and the lists it names: tables, inheritance, faults, where each value is written."""
