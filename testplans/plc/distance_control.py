"""FCT-M3 10 by the control unit of axis Z: set position, ON, FREEZE, ON, OFF.

It begins when the NC program writes V.E.REFERENCED. V.E.PART, read here, says how far it goes: 1
set position, 2 surface offset, 3 freeze, 4 on again, 5 off.
V.E.SURFACE, V.E.OFFSET, V.E.STATE, V.E.SOURCE, where the plan has them: what the unit shows.
"""

from axisrig.bench.machine.plc.hli import (
    HLI_DIST_CTRL_FREEZE,
    HLI_DIST_CTRL_OFF,
    HLI_DIST_CTRL_ON,
    Hli,
    Inputs,
)

AXIS = "Z"
MS = 1_000_000
SET_POS = 400_000  # 40 mm in 0.1 um
COMMANDS = (
    (100 * MS, HLI_DIST_CTRL_ON),
    (600 * MS, HLI_DIST_CTRL_FREEZE),
    (1000 * MS, HLI_DIST_CTRL_ON),
    (1300 * MS, HLI_DIST_CTRL_OFF),
)


class DistanceControl:
    """Commands one after the other, each as soon as the unit has taken the one before."""

    def __init__(self) -> None:
        self._begin_ns = -1
        self._given = 0

    def cycle(self, inputs: Inputs, hli: Hli) -> None:
        """Give the next command at its time, and show the state."""
        unit = hli.ax[AXIS].lr_mc_control.distance_control
        unit.enable_w = True
        if self._begin_ns < 0 and hli.ve["REFERENCED"]:
            self._begin_ns = inputs.time_ns
            unit.command_w.set_pos = SET_POS
        last = max(1, int(hli.ve["PART"]) - 1)
        if self._begin_ns >= 0 and self._given < last and not unit.command_semaphor_rw:
            after_ns, transition = COMMANDS[self._given]
            if inputs.time_ns - self._begin_ns >= after_ns:
                unit.command_w.transition, unit.command_semaphor_rw = transition, True
                self._given += 1
        state = unit.state_r
        shown = {
            "SURFACE": state.surface,
            "OFFSET": state.actual_offset,
            "STATE": state.state,
            "SOURCE": state.source,
        }
        for name, value in shown.items():
            if name in hli.ve:
                hli.ve[name] = value
