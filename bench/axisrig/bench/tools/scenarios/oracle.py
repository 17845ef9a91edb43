"""Judges what a scenario left, by the plant alone: nothing of kernel or drive computes a truth.

The truth of a measurement run is the motor position one input delay after the first edge that the
probe FMU gave in it. A value that the program was given counts as good, whatever else happened.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from enum import StrEnum

from axisrig.bench.machine.machine import Machine
from axisrig.bench.oracles.interpolation import cubic
from axisrig.kernel.channel import Channel
from axisrig.kernel.cosim.plant.axis import AXIS_OUTPUTS
from axisrig.kernel.time.clock import MS, US, TimeNs

INPUT_DELAY_NS = 500 * US
INCREMENTS_PER_MM = 104_857.6
INCREMENTS_MAX = 1.0
"""Rounding of the encoder and of the published number."""
CALM_NS = 300 * MS
"""How long after the end of the program an axis may still move."""
REST_MM = 0.01
"""How far it may move in the 50 ms after that: friction lets it creep by a micrometre, while the
lowest feed goes 0.25 mm."""
MOTOR = AXIS_OUTPUTS.index("motor_position")
"""The rate of the motor position is the next output."""
BRAKING_NS = 30 * MS
"""From the alarm until the set position is constant: 60 mm/s at 4000 mm/s2 take 15 ms."""


class Result(StrEnum):
    """What a scenario showed; the last five are defects."""

    GOOD = "every value right, no alarm above a warning"
    ALARM = "alarm"
    WRONG = "WRONG VALUE reported as good"
    MOVES = "axis does not stop after the alarm"
    SLOW = "set position does not stop after the alarm"
    HANG = "program does not end"
    EXCEPTION = "exception"


DEFECTS = (Result.WRONG, Result.MOVES, Result.SLOW, Result.HANG, Result.EXCEPTION)


@dataclass
class Judgement:
    """alarms: in their order. right: number of values that are true. note: of a defect."""

    result: Result
    alarms: list[int] = field(default_factory=list)
    right: int = 0
    note: str = ""


class Truth:
    """Keeps the motor position at each edge; an observer of the channel."""

    def __init__(self, machine: Machine, rising: bool) -> None:
        self._axis = machine.plant.axes["z"]
        self._plant, self._signal = machine.plant, machine.plant.probes["probe"].signal
        self._rising = rising
        self._seen = 0
        self.latches: list[tuple[TimeNs, float]] = []
        """(edge, motor position in mm one input delay later)."""

    def __call__(self, _channel: Channel | None = None) -> None:
        """Look up what the plant has passed since the last call."""
        edges = self._signal.edges
        while self._seen < len(edges):
            edge_ns, level = edges[self._seen]
            if edge_ns + INPUT_DELAY_NS > self._plant.now_ns:
                return
            if level == self._rising:
                position_m = self._motor_position_m_at(edge_ns + INPUT_DELAY_NS)
                self.latches.append((edge_ns, position_m * 1e3))
            self._seen += 1

    def _motor_position_m_at(self, time_ns: TimeNs) -> float:
        """Return where the motor was, apart from what the drive takes for its latch."""
        (begin_ns, begin), (end_ns, end) = self._axis.ends_around(time_ns)
        if end_ns == begin_ns:
            return begin[MOTOR]
        ends = (begin[MOTOR], begin[MOTOR + 1], end[MOTOR], end[MOTOR + 1])
        return cubic((time_ns - begin_ns) * 1e-9, (end_ns - begin_ns) * 1e-9, ends)


def judge(machine: Machine, truth: Truth) -> Judgement:
    """Judge a run that has come to its end; the plant is stepped on to see if it is at rest."""
    truth()
    alarms = [alarm.id for alarm in machine.channel.alarms]
    values = _values(machine)
    right = 0
    for run, value_mm in values:
        wrong = _what_is_wrong(machine, truth, run, value_mm)
        if wrong:
            return Judgement(Result.WRONG, alarms, right, f"run {run + 1}: {wrong}")
        right += 1
    ending = [
        alarm_ns
        for alarm, alarm_ns in zip(machine.channel.alarms, machine.channel.alarm_ns, strict=True)
        if alarm.ends_program
    ]
    if not ending:
        return Judgement(Result.GOOD, alarms, right)
    took_ns = machine.end_ns - ending[0]
    if took_ns > BRAKING_NS:
        return Judgement(Result.SLOW, alarms, right, f"{took_ns / 1e6:.1f} ms")
    moved_mm = _movement_mm(machine)
    if moved_mm > REST_MM:
        return Judgement(Result.MOVES, alarms, right, f"{moved_mm:.4f} mm in 50 ms")
    return Judgement(Result.ALARM, alarms, right)


def _values(machine: Machine) -> list[tuple[int, float]]:
    """Every value reported as good: printed by the program, or published by the channel."""
    printed = [
        (["first", "second"].index(message.text.split()[0]), float(message.values[0]))
        for message in machine.messages
    ]
    published = [
        (run, value)
        for run, record in enumerate(machine.channel.records)
        for value in record.latched_mm.values()
        if record.end_ns is not None
    ]
    return [*printed, *published]


def _what_is_wrong(machine: Machine, truth: Truth, run: int, value_mm: float) -> str:
    record = machine.channel.records[run]
    start_ns = record.start_ns if record.start_ns is not None else record.begin_ns
    end_ns = record.end_ns if record.end_ns is not None else machine.end_ns
    inside = [mm for edge_ns, mm in truth.latches if start_ns <= edge_ns <= end_ns]
    if not inside:
        return f"{value_mm:.6f} mm without an edge of the probe"
    off = (value_mm - inside[0]) * INCREMENTS_PER_MM
    if abs(off) > INCREMENTS_MAX:
        return f"{value_mm:.6f} mm, true are {inside[0]:.6f} mm: off by {off:.1f} increments"
    return ""


def _movement_mm(machine: Machine) -> float:
    """How far the load moves in 50 ms, CALM_NS after the end."""
    plant, axis = machine.plant, machine.plant.axes["z"]
    end_ns = max(plant.now_ns, machine.scheduler.now_ns)
    places: Sequence[float] = []
    for after_ns in (CALM_NS, CALM_NS + 50 * MS):
        machine.scheduler.run_until(end_ns + after_ns)
        plant.advance_to(end_ns + after_ns)
        places = [*places, axis.position_m() * 1e3]
    return abs(places[1] - places[0])
