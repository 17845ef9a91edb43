"""One probe for three axes, its signal at the unit of one of them: source PLC_FIRST_EVENT.

Every unit is enabled, Z alone has the level of the probe; the others keep the level of the free
probe, so that an edge of either kind is an event of Z. The first event of any axis counts for all.
"""

from axisrig.bench.machine.plc.hli import Hli, Inputs

WIRED = "Z"


class FirstEvent:
    """The unit of every axis is served, the probe is at one."""

    def __init__(self) -> None:
        self._free: bool | None = None  # level of the first cycle

    def cycle(self, inputs: Inputs, hli: Hli) -> None:
        """Copy input 1 of the terminal to `probing_signal` of the axis that it is wired to."""
        level = inputs.channel[1].input
        self._free = level if self._free is None else self._free
        for name, axis in hli.ax.items():
            unit = axis.lr_mc_control.probing_signal
            unit.enable_w = inputs.wc_state == 0
            unit.command_w = level if name == WIRED else self._free
