"""One probe for three axes, its signal at the unit of one of them: source PLC_FIRST_EVENT.

Every unit is enabled, Z alone has the level of the probe; the first event of any axis counts for
all.
"""

from axisrig.bench.machine.plc.hli import Hli, Inputs

WIRED = "Z"


class FirstEvent:
    """The unit of every axis is served, the probe is at one."""

    def cycle(self, inputs: Inputs, hli: Hli) -> None:
        """Copy input 1 of the terminal to `probing_signal` of the axis that it is wired to."""
        for name, axis in hli.ax.items():
            unit = axis.lr_mc_control.probing_signal
            unit.enable_w = inputs.wc_state == 0
            unit.command_w = name == WIRED and inputs.channel[1].input
