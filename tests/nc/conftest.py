"""A machine of one number: its probe signals where one axis crosses a plane."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TypeVar

import pytest

from axisrig.kernel.nc.canon import Command, LinearMove, MeasuringRun, Message, Wait
from axisrig.kernel.nc.coordinates import OffsetTables
from axisrig.kernel.nc.decoder import Interpreter
from axisrig.kernel.nc.decoder.base.context import ChannelControl
from axisrig.kernel.nc.text.parser import parse_program, read_program

PROGRAMS = Path(__file__).parents[2] / "testplans" / "programs"
XYZ = ("X", "Y", "Z")
Kind = TypeVar("Kind")


class PlaneMachine:
    """Executes what it was given only when the interpreter waits, as a channel may.

    start_acs_mm: where the axes stand. plane: axis and position at which the probe signals;
    None for a probe that never does. silent: axes whose signal line is broken.
    """

    def __init__(
        self,
        start_acs_mm: Mapping[str, float],
        plane: tuple[str, float] | None,
        silent: Sequence[str] = (),
    ) -> None:
        self.acs_mm = dict(start_acs_mm)
        self.plane = plane
        self.silent = silent
        self.lag_mm = 0.0
        self.not_released: tuple[str, ...] = ()
        self.latched: dict[str, float | None] = {}
        self.queue: list[Command] = []

    def position_acs_mm(self, axis: str) -> float:
        assert not self.queue, "position read before everything was executed"
        return self.acs_mm[axis]

    def measured_acs_mm(self, axis: str) -> float | None:
        return self.latched.get(axis)

    def measurement_ok(self, axis: str) -> bool:
        return self.latched.get(axis) is not None

    def is_measuring(self, axis: str) -> bool:
        return False

    def actual_acs_mm(self, axis: str) -> float:
        return self.acs_mm[axis] + self.lag_mm

    def is_sercos(self, axis: str) -> bool:
        return False

    def may_measure(self, axis: str) -> bool:
        return axis not in self.not_released

    def distance_state(self, axis: str) -> str | None:
        return None

    def channel_distance(self) -> ChannelControl | None:
        return None

    def axis_numbered(self, number: int) -> str | None:
        return dict(enumerate(self.acs_mm, 1)).get(number)

    def execute(self) -> None:
        for command in self.queue:
            if isinstance(command, LinearMove):
                self.acs_mm.update(command.target_mm)
            elif isinstance(command, MeasuringRun):
                self._measure(command)
        self.queue.clear()

    def _measure(self, run: MeasuringRun) -> None:
        target = {**self.acs_mm, **run.target_mm}
        share = 1.0
        hit = False
        if self.plane is not None:
            axis, position_mm = self.plane
            path_mm = target[axis] - self.acs_mm[axis]
            if path_mm and 0 <= (position_mm - self.acs_mm[axis]) / path_mm <= 1:
                share, hit = (position_mm - self.acs_mm[axis]) / path_mm, True
        reached_mm = {
            axis: (
                self.plane[1]
                if hit and self.plane is not None and axis == self.plane[0]
                else start + share * (target[axis] - start)
            )
            for axis, start in self.acs_mm.items()
        }
        self.acs_mm = target if run.goes_on else reached_mm
        self.latched = {
            axis: reached_mm[axis] if hit and axis not in self.silent else None
            for axis in run.measuring_axes
        }


def run_text(
    text: str,
    machine: PlaneMachine | None = None,
    *,
    axes: Sequence[str] = XYZ,
    external: Mapping[str, float] | None = None,
    default_measuring_type: int = 1,
    tables: OffsetTables | None = None,
) -> list[Command]:
    """Run a program to its end; the commands up to an alarm are lost with it."""
    machine = machine or PlaneMachine(dict.fromkeys(axes, 0.0), None)
    interpreter = Interpreter(
        parse_program(text, file="test.nc", axes=axes),
        axes,
        machine,
        external=external or {},
        default_measuring_type=default_measuring_type,
        tables=tables,
    )
    return drive(interpreter, machine)


def run_file(name: str, machine: PlaneMachine, axes: Sequence[str] = XYZ) -> list[Command]:
    """Run one of the programs that are delivered with the plans."""
    program = read_program(PROGRAMS / name, axes)
    return drive(Interpreter(program, axes, machine, external={}), machine)


def drive(interpreter: Interpreter, machine: PlaneMachine) -> list[Command]:
    """Play the channel: queue commands, execute them when the interpreter waits."""
    commands = []
    for command in interpreter.commands():
        commands.append(command)
        machine.queue.append(command)
        if isinstance(command, Wait):
            machine.execute()
    machine.execute()
    return commands


def of(commands: Sequence[Command], *kinds: type[Kind]) -> list[Kind]:
    """The commands of these kinds, in their order."""
    return [command for command in commands if isinstance(command, kinds)]


def texts(commands: Sequence[Command]) -> list[str]:
    """The texts of the messages."""
    return [message.text for message in of(commands, Message)]


@pytest.fixture(scope="session")
def plane_machine() -> type[PlaneMachine]:
    return PlaneMachine


@pytest.fixture(scope="session")
def run() -> Callable[..., list[Command]]:
    return run_text


@pytest.fixture(scope="session")
def run_program() -> Callable[..., list[Command]]:
    return run_file
