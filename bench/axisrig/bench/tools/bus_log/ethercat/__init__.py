"""Frames of EtherCAT lines in words."""
