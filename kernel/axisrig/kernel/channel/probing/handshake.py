"""Tasks for the hardware of a probe, and how long each may wait for its acknowledgement.

Sources: FCT-C4 7.2 and 7.4.
"""

from axisrig.kernel.errors import Alarm
from axisrig.kernel.plc.probing import LatchOrder, LatchTask, PlcTask, ProbingUnit
from axisrig.kernel.time.clock import MS, Clock


class Handshake:
    """The tasks of one axis; probe_input, edge: that go with them.

    `check` raises Alarm 50050 when PREPARE or ENABLE is not acknowledged in time, 900406 when
    DISABLE is not, 900402 when the task of the PLC is silent meanwhile.
    """

    def __init__(self, axis: str, unit: ProbingUnit, task: PlcTask, clock: Clock) -> None:
        self._axis, self._unit, self._task, self._clock = axis, unit, task, clock
        self.probe_input, self.edge = 1, "POS"
        self.is_enabled = self.is_prepared = False

    @property
    def is_idle(self) -> bool:
        """Whether every task is acknowledged."""
        return self._unit.is_idle

    @property
    def is_ready(self) -> bool:
        """Whether the hardware is enabled and has acknowledged it."""
        return self.is_enabled and self._unit.is_idle

    def _give(self, task: LatchTask) -> None:
        order = LatchOrder(task, self.probe_input, self.edge)
        self._unit.give(order, self._clock.now_ns)

    def prepare(self) -> None:
        """Ask for a probe that is ready early (#MEAS PREPARE)."""
        if not (self.is_prepared or self.is_enabled):
            self.is_prepared = True
            self._give(LatchTask.PREPARE)

    def enable(self) -> None:
        """Ask for the probe or its hardware at the start of a run."""
        self.is_enabled = True
        self._give(LatchTask.ENABLE)

    def disable(self) -> None:
        """Ask to switch it off, where it has been asked for."""
        if self.is_enabled or self.is_prepared:
            self.is_enabled = self.is_prepared = False
            self._give(LatchTask.DISABLE)

    def check(self) -> None:
        """Look whether a task waits too long; for a run that waits for it."""
        unit, task, now_ns = self._unit, self._task, self._clock.now_ns
        if unit.is_idle:
            return
        silent_ns = task.silent_ns(now_ns)
        if silent_ns is not None:
            raise Alarm(900402, axis=self._axis, ms=f"{silent_ns / MS:g}")
        waited_ns = now_ns - unit.given_ns
        if waited_ns <= task.acknowledge_ns:
            return
        if unit.order.task is LatchTask.DISABLE:
            raise Alarm(900406, axis=self._axis, ms=f"{waited_ns / MS:g}")
        raise Alarm(50050, axis=self._axis)
