"""Hands the level of a digital input over as the probing signal of axis Z: source PLC.

The terminal is on the fieldbus of the PLC; while it does not answer nothing is enabled, so that a
measurement run ends in an alarm and never waits for a signal that cannot come.
"""

from axisrig.bench.machine.plc.hli import Hli, Inputs

AXIS = "Z"


class ProbeSignal:
    """FCT-C4 7.1: the PLC reads the probe, the CNC judges the edge and takes the actual value."""

    def cycle(self, inputs: Inputs, hli: Hli) -> None:
        """Copy input 1 of the terminal to `probing_signal`."""
        unit = hli.ax[AXIS].lr_mc_control.probing_signal
        unit.enable_w = inputs.wc_state == 0
        unit.command_w = inputs.channel[1].input
