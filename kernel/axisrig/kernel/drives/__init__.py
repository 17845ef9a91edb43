"""Drives as the CNC sees them over the bus: profile tables of CiA 402 and the link to one drive.

`ds402.py` reads the tables `ds402_*.csv`; master and slave use the same ones.
"""
