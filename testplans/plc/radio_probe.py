"""Switches a radio probe on and off whose signal the drive of axis Z latches: EXT_PROBE_WITH_DRIVE.

The probe needs V.E.SWITCH_ON_MS until its signal is valid; -1: the PLC never acknowledges.
V.E.DISABLE_MS: how long the acknowledgement of switching off takes, -1: it never comes. The tasks
are counted in V.E.PREPARES, V.E.ENABLES and V.E.DISABLES where the plan has these.
"""

from axisrig.bench.machine.plc.hli import (
    HLI_EXT_LATCH_DISABLE_PROBE,
    HLI_EXT_LATCH_ENABLE_PROBE,
    HLI_EXT_LATCH_PREPARE_PROBE,
    Hli,
    Inputs,
)

AXIS = "Z"
NEVER = 1 << 62
MS = 1_000_000
COUNTERS = {
    HLI_EXT_LATCH_PREPARE_PROBE: "PREPARES",
    HLI_EXT_LATCH_ENABLE_PROBE: "ENABLES",
    HLI_EXT_LATCH_DISABLE_PROBE: "DISABLES",
}


class RadioProbe:
    """FCT-C4 7.2: PREPARE and ENABLE switch the probe on, DISABLE switches it off."""

    def __init__(self) -> None:
        self.probe_on = False
        self._ready_ns = NEVER  # the probe is ready when it is on
        self._done_ns = NEVER  # when the task is acknowledged

    def cycle(self, inputs: Inputs, hli: Hli) -> None:
        """Go on with the handshake."""
        unit, now_ns = hli.ax[AXIS].lr_mc_control.ext_latch, inputs.time_ns
        if unit.please_rw:
            unit.please_rw = unit.done_w = False
            if unit.task_r == HLI_EXT_LATCH_DISABLE_PROBE:
                self.probe_on = False
                self._done_ns = _due_ns(now_ns, hli.ve.get("DISABLE_MS", 0))
            else:
                if not self.probe_on:
                    self._ready_ns = _due_ns(now_ns, hli.ve.get("SWITCH_ON_MS", 0))
                self.probe_on = True
                self._done_ns = self._ready_ns
        if now_ns >= self._done_ns:
            unit.done_w, self._done_ns = True, NEVER
            counter = COUNTERS[unit.task_r]
            if counter in hli.ve:
                hli.ve[counter] += 1


def _due_ns(now_ns: int, after_ms: float) -> int:
    return NEVER if after_ms < 0 else now_ns + int(after_ms * MS)
