"""Torque limit and lag window of the drive set by the PLC side instead of #DRIVE (FCT-C4 7.3, notice)."""
