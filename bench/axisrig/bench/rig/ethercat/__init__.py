"""Drives on EtherCAT on paper: keys, checks, the arithmetic of a cycle."""
