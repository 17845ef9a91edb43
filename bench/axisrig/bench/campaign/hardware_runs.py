"""Runs whose drives are real: which interface, what may not be, and who allows the motion."""

import signal
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, contextmanager, suppress
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from axisrig.bench.bus.can.hardware import SIMULATED, parse_options
from axisrig.bench.bus.paced import RealTime
from axisrig.bench.machine.pacing import Hardware
from axisrig.bench.plan.assignment import Assignment, parse_assignment
from axisrig.bench.plan.case import Case
from axisrig.bench.plan.plan import Plan
from axisrig.bench.rig.families import family_of
from axisrig.bench.rig.reading.carriers import refusal
from axisrig.bench.rig.reading.file import read_rig
from axisrig.bench.rig.reading.foreign import foreign_plants
from axisrig.bench.rig.reading.tables import SegmentKeys
from axisrig.bench.rig.real_axes import is_paced, outside_axes, simulated_plants
from axisrig.bench.rig.settings import Settings, as_written, read_settings
from axisrig.kernel.errors import UserError


@dataclass(frozen=True)
class Outside:
    """What the command line says of interfaces; None = as the rig has it.

    open_hardware: gives real time and catches Ctrl-C, only while axes outside are driven.
    may_move: the operator has allowed the motion. put_out: takes what he should read before.
    options: texts `key=value`. segment: of the rig, where it has several.
    """

    open_hardware: Callable[[], AbstractContextManager[Hardware]]
    may_move: bool
    put_out: Callable[[str], None]
    interface: str | None = None
    channel: str | None = None
    options: Sequence[str] | None = None
    bitrate: int | None = None
    segment: str | None = None

    @property
    def says_anything(self) -> bool:
        """Whether the command line says anything of an interface."""
        return any((self.interface, self.channel, self.bitrate, self.options))

    def changes(self, segments: Mapping[str, SegmentKeys], file: Path) -> list[Assignment]:
        """Return the assignments that put the interface onto a segment of a rig.

        Raises UserError when it is not clear onto which one.
        """
        said: dict[str, str | None] = {
            "interface": self.interface,
            "channel": self.channel,
            "bitrate": None if self.bitrate is None else str(self.bitrate),
            "options": " ".join(self.options) if self.options else None,
        }
        if not self.says_anything:
            return []
        parse_options(said["options"] or "")
        buses = self._buses(segments, file)
        if self.segment is None and len(buses) != 1:
            raise UserError(
                "the rig has several segments: say which one the interface is for",
                file=file,
                allowed=buses,
                hint="--segment NAME, or interface and channel in the rig",
            )
        name = self.segment or buses[0]
        return [
            parse_assignment(f"bus:{name}.{key}={value}") for key, value in said.items() if value
        ]

    def _buses(self, segments: Mapping[str, SegmentKeys], file: Path) -> list[str]:
        """Return the segments that an interface can be for: their carrier has this key."""
        if self.segment is not None and self.segment not in segments:
            raise UserError("the rig has no such segment", value=self.segment, allowed=segments)
        buses = [
            name for name, table in segments.items() if "interface" in type(table).model_fields
        ]
        if segments and (self.segment or "") not in buses and (self.segment or not buses):
            name = self.segment or next(iter(segments))
            raise refusal("run --interface", name, file=file)
        return buses

    def changes_of(self, plan: Plan) -> list[Assignment]:
        """Return the assignments for the cases of a plan. Raises UserError as `changes`."""
        if not self.says_anything:
            return []
        by_rig = {
            tuple(self.changes(read_rig(rig)[0].segment, rig))
            for rig in dict.fromkeys(case.rig for case in plan.cases)
        }
        if len(by_rig) > 1:
            raise UserError(
                "the rigs of this plan name their segments differently",
                file=plan.path,
                hint="give each rig its interface and channel in its file",
            )
        return [item for items in by_rig for item in items]


def real_cases(cases: Sequence[Case]) -> list[Settings]:
    """Return the different settings, as far as buses and drives go, of cases with a real bus.

    What is wrong with a case comes from its preparation, with its place; here it is left out.
    """
    found = []
    for rig, buses, everything in sorted({(case.rig, *_inputs(case)) for case in cases}):
        with suppress(UserError):
            if is_paced(_settings(rig.absolute(), buses)):
                found.append(_settings(rig.absolute(), everything))
    return found


_Inputs = tuple[tuple[str, str], ...]


def _inputs(case: Case) -> tuple[_Inputs, _Inputs]:
    """Return what a case says of its buses, and of buses and drives."""
    said = [a for a in case.assignments() if a.kind in ("bus", "drive")]
    everything = tuple((a.column, a.value) for a in said)
    return tuple((a.column, a.value) for a in said if a.kind == "bus"), everything


@cache
def _settings(rig: Path, inputs: _Inputs) -> Settings:
    table, files = read_rig(rig)
    changes = [(parse_assignment(f"{column}={value}"), as_written) for column, value in inputs]
    return read_settings(table, files, changes)


@contextmanager
def stoppable(real_time: RealTime, put_out: Callable[[str], None]) -> Iterator[Hardware]:
    """Let Ctrl-C (and SIGTERM) ask for a controlled stop; the second one breaks off."""
    asked: list[int] = []

    def on_signal(number: int, _frame: object) -> None:
        asked.append(number)
        if len(asked) > 1:
            raise KeyboardInterrupt
        put_out("stopping; once more to break off")

    stops = (signal.SIGINT, signal.SIGTERM)
    before = {number: signal.signal(number, on_signal) for number in stops}
    try:
        yield Hardware(real_time, lambda: bool(asked))
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def allow(rigs: Sequence[Settings], outside: Outside) -> None:
    """Say what will move; raise UserError unless the operator or every rig has allowed it."""
    lines = [
        f"axis {name}: {family_of(settings, name).outside(settings, name)}"
        for settings in rigs
        for name in sorted(outside_axes(settings))
    ]
    if not lines:
        return
    outside.put_out("these axes will move on real hardware:")
    for line in dict.fromkeys(lines):
        outside.put_out(f"  {line}")
    foreign = [name for settings in rigs for name in foreign_plants(simulated_plants(settings))]
    for name in dict.fromkeys(foreign):
        outside.put_out(
            f"plant {name} is a foreign FMU in this process: if it ends the process, nothing brakes"
            " the axes but the drives' own watch over SYNC and heartbeat"
        )
    allowed = outside.may_move or all(
        settings.rig.hardware for settings in rigs if outside_axes(settings)
    )
    if not allowed:
        raise UserError(
            "real axes move only when the operator allows it",
            hint="see that nobody is in the machine, then add --yes (or hardware = true in"
            " the rig)",
        )
    outside.put_out("Ctrl-C brakes them and powers the drives down")


def refuse_processes(jobs: int, is_apart: bool) -> None:
    """Refuse what needs processes of their own: a bus has one master, and its end is controlled."""
    if jobs > 1 or is_apart:
        raise UserError(
            "a real CAN interface is driven from this process, one case after the other",
            hint="leave out --jobs, --timeout, --isolate, --call-timeout and --engine, or use"
            f" {SIMULATED}",
        )
