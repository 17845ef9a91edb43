"""The example of FCT-C4 7.5: a probe at channel 2 of an EL1252, axis 2 (Y) measures: PLC_TIMESTAMP.

`Input` of the channel goes to `probing_signal`, `LatchPos2` to `timestamp`, in the same cycle;
after a falling edge `LatchNeg2`, for P-AXIS-00518 = NEG.
"""

from axisrig.bench.machine.plc.hli import Hli, Inputs

AXIS = "Y"
CHANNEL = 2


class El1252Channel2:
    """Links of the terminal to the control units."""

    def cycle(self, inputs: Inputs, hli: Hli) -> None:
        """Hand state and stamp over."""
        channel, control = inputs.channel[CHANNEL], hli.ax[AXIS].lr_mc_control
        control.probing_signal.enable_w = control.timestamp.enable_w = inputs.wc_state == 0
        control.probing_signal.command_w = channel.input
        stamp_ns = channel.latch_pos_ns if channel.input else channel.latch_neg_ns
        control.timestamp.command_w = stamp_ns
