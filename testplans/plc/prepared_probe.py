"""Switches one radio probe for several axes, and keeps a record of the tasks of each.

Sources EXT_PROBE_WITH_DRIVE and PLC_EXT_LATCH_CONTROL. Variables of the plan, written here:

V.E.TASKS_<axis>: a digit for each task that was read, 1 ENABLE, 2 DISABLE, 3 PREPARE, so that
312 is a run with a prepared probe. V.E.DONE_<axis>: one for each that done_w has acknowledged.
V.E.INPUT_<axis>, V.E.FALLING_<axis>: input and edge of the last task. V.E.IN_ERROR: 1 when the
channel was in ERROR as the last DISABLE came. V.E.NUMBER, where the plan has it: `task` of the rig.

Read here: V.E.PREPARE_MS, V.E.ENABLE_MS, V.E.DISABLE_MS, how long each acknowledgement takes, -1 it
never comes.
"""

from axisrig.bench.machine.plc.hli import (
    HLI_EXT_LATCH_DISABLE_PROBE,
    HLI_EXT_LATCH_ENABLE_PROBE,
    HLI_EXT_LATCH_PREPARE_PROBE,
    AxisHli,
    Hli,
    Inputs,
)

NEVER = 1 << 62
MS = 1_000_000
TIMES = {
    HLI_EXT_LATCH_PREPARE_PROBE: "PREPARE_MS",
    HLI_EXT_LATCH_ENABLE_PROBE: "ENABLE_MS",
    HLI_EXT_LATCH_DISABLE_PROBE: "DISABLE_MS",
}


class PreparedProbe:
    """FCT-C4 7.2 and 7.4: the probe is on while any axis has prepared or enabled it."""

    def __init__(self) -> None:
        self.probe_on = False
        self._done_ns: dict[str, int] = {}
        self._is_on: dict[str, bool] = {}
        self._is_enabled: dict[str, bool] = {}
        self._level: bool | None = None

    def cycle(self, inputs: Inputs, hli: Hli) -> None:
        """Go on with the handshake of each axis, then report the edge of its task."""
        level = inputs.channel[1].input
        has_changed = self._level is not None and self._level is not level
        for name, axis in hli.ax.items():
            self._serve(name, axis, inputs, hli)
            signal, unit = axis.lr_mc_control.probing_signal, axis.lr_mc_control.ext_latch
            signal.enable_w = inputs.wc_state == 0
            if not self._is_enabled.get(name, False):
                signal.command_w = False
            elif has_changed and level is (unit.edge_r == "POS"):
                signal.command_w = True
        self._level = level
        self.probe_on = any(self._is_on.values())

    def _serve(self, name: str, axis: AxisHli, inputs: Inputs, hli: Hli) -> None:
        unit, now_ns = axis.lr_mc_control.ext_latch, inputs.time_ns
        if unit.please_rw:
            unit.please_rw = unit.done_w = False
            _note(hli, f"TASKS_{name}", unit.task_r)
            hli.ve[f"INPUT_{name}"] = unit.input_r
            if "NUMBER" in hli.ve:
                hli.ve["NUMBER"] = unit.task_number_r
            hli.ve[f"FALLING_{name}"] = int(unit.edge_r == "NEG")
            self._is_on[name] = unit.task_r != HLI_EXT_LATCH_DISABLE_PROBE
            if unit.task_r == HLI_EXT_LATCH_DISABLE_PROBE:
                hli.ve["IN_ERROR"] = int(hli.ch.state_r == "ERROR")
            self._is_enabled[name] = unit.task_r == HLI_EXT_LATCH_ENABLE_PROBE
            after_ms = hli.ve[TIMES[unit.task_r]]
            self._done_ns[name] = NEVER if after_ms < 0 else now_ns + int(after_ms * MS)
        if now_ns >= self._done_ns.get(name, NEVER):
            unit.done_w, self._done_ns[name] = True, NEVER
            _note(hli, f"DONE_{name}", unit.task_r)


def _note(hli: Hli, record: str, task: int) -> None:
    hli.ve[record] = 10 * hli.ve[record] + task
