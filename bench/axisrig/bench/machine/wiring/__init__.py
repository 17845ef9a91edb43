"""Wires between the plant and who reads it: drives, terminals, PLC. A fault changes what comes."""
