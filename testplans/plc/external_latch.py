"""Serves external measuring hardware for axis Z: source PLC_EXT_LATCH_CONTROL.

The hardware is a terminal that is armed by ENABLE and reports the edge that the task names.
Variables of the plan: V.E.ENABLE_CYCLES, V.E.DISABLE_CYCLES how many cycles each acknowledge takes,
-1 never; V.E.POSITION 1 = the position that the HLI shows is handed over as `probing_position`.
"""

from axisrig.bench.machine.plc.hli import HLI_EXT_LATCH_ENABLE_PROBE, Hli, Inputs

AXIS = "Z"


class ExternalLatch:
    """FCT-C4 7.4: read the task, enable the hardware, acknowledge, then report its latch."""

    def __init__(self) -> None:
        self._waits = -1  # cycles to the acknowledgement, -1 none is due
        self._is_armed = False
        self._level: bool | None = None

    def cycle(self, inputs: Inputs, hli: Hli) -> None:
        """Go on with the handshake, then look at the hardware."""
        control = hli.ax[AXIS].lr_mc_control
        unit = control.ext_latch
        if unit.please_rw:
            unit.please_rw = unit.done_w = False
            is_enable = unit.task_r == HLI_EXT_LATCH_ENABLE_PROBE
            self._is_armed = False
            control.probing_signal.command_w = False
            name = "ENABLE_CYCLES" if is_enable else "DISABLE_CYCLES"
            self._waits = int(hli.ve.get(name, 0))
        if self._waits == 0:
            unit.done_w, self._waits = True, -1
            self._is_armed = unit.task_r == HLI_EXT_LATCH_ENABLE_PROBE
        elif self._waits > 0:
            self._waits -= 1
        level, wanted = inputs.channel[1].input, unit.edge_r == "POS"
        has_edge = level is wanted and self._level is not None and self._level is not level
        self._level = level
        control.probing_signal.enable_w = inputs.wc_state == 0
        if self._is_armed and has_edge:
            control.probing_position.enable_w = bool(hli.ve.get("POSITION", 0))
            control.probing_position.command_w = hli.ax[AXIS].lr_state.position_r
            control.probing_signal.command_w = True
