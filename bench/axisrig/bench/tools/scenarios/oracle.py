"""Judges what a scenario left, by the plant alone: nothing of kernel or drive computes a truth.

The truth of a measurement run is the motor position at the latch instant of the first edge that the
probe FMU gave in it (`bench.record.edges`). A value that the program was given counts as good,
whatever else happened.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from enum import StrEnum

from axisrig.bench.machine.machine import Machine
from axisrig.bench.record.edges import EdgeTruth, edges_of
from axisrig.kernel.time.clock import MS

INCREMENTS_PER_MM = 104_857.6
INCREMENTS_MAX = 1.0
"""Rounding of the encoder and of the published number."""
CALM_NS = 300 * MS
"""How long after the end of the program an axis may still move."""
REST_MM = 0.01
"""How far it may move in the 50 ms after that: friction lets it creep by a micrometre, while the
lowest feed goes 0.25 mm."""
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


def judge(machine: Machine, rising: bool) -> Judgement:
    """Judge a run that has come to its end; the plant is stepped on to see if it is at rest.

    rising: the edge that counts.
    """
    edges = [row for row in machine.edges.rows() if row.level == rising]
    alarms = [alarm.id for alarm in machine.channel.alarms]
    values = _values(machine)
    right = 0
    for run, value_mm in values:
        wrong = _what_is_wrong(machine, edges, run, value_mm)
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


def _what_is_wrong(machine: Machine, edges: Sequence[EdgeTruth], run: int, value_mm: float) -> str:
    record = machine.channel.records[run]
    start_ns = record.start_ns if record.start_ns is not None else record.begin_ns
    end_ns = record.end_ns if record.end_ns is not None else machine.end_ns
    watched = edges_of(edges, axis="Z", begin_ns=start_ns, end_ns=end_ns)
    inside = [row.latch_motor_mm for row in watched if row.latch_motor_mm is not None]
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
