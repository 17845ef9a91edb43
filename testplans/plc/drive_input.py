"""Hands a digital input of the drive over as the probing signal of axis Z: source PLC.

The probe is wired to input 1 of the drive, which samples it at the SYNC and sends 60FD; the PLC
reads it from the HLI. For a drive without touch probe function: one that has it latches better.
"""

from axisrig.bench.machine.plc.hli import Hli, Inputs

AXIS = "Z"
INPUT_1 = 1 << 16  # of 60FD


class DriveInput:
    """FCT-C4 7.1 with the probe at a digital input of a drive."""

    def cycle(self, inputs: Inputs, hli: Hli) -> None:
        """Copy input 1 of the drive to `probing_signal`."""
        axis = hli.ax[AXIS]
        unit = axis.lr_mc_control.probing_signal
        unit.enable_w = True
        unit.command_w = bool(axis.lr_state.digital_inputs_r & INPUT_1)
