"""Texts of PLC programs of tests."""

HEAD = "from axisrig.bench.machine.plc.hli import Hli, Inputs\n\n\nclass Program:\n"
"""A class follows."""
IDLE = "    def cycle(self, inputs, hli):\n        pass\n"
"""A cycle that does nothing."""
