"""Statements of single axes as the text rooms make them, and what the decoder makes of them."""

from collections.abc import Mapping
from typing import Any

from axisrig.kernel.nc import canon
from axisrig.kernel.nc.block import Block
from axisrig.kernel.nc.decoder import Interpreter
from axisrig.kernel.nc.decoder.base.context import ChannelControl
from axisrig.kernel.nc.syntax import (
    AxisCommand,
    Command,
    Name,
    Number,
    Option,
    Program,
    ProgramBlock,
    Words,
)

AXES = ("X", "Y", "Z", "C", "X2")


class Machine:
    """Axes that are at their targets when the interpreter waits; measured: what a run brings."""

    def __init__(self) -> None:
        self.acs_mm = dict.fromkeys(AXES, 0.0)
        self.measured: dict[str, float] = {}
        self.measuring: set[str] = set()
        self.homes: dict[str, float] = {}
        self.queue: list[canon.Command] = []

    def position_acs_mm(self, axis: str) -> float:
        assert not self.queue, "position read before everything was executed"
        return self.acs_mm[axis]

    def is_measuring(self, axis: str) -> bool:
        assert not self.queue, "asked before everything was executed"
        return axis in self.measuring

    def actual_acs_mm(self, axis: str) -> float:
        return self.position_acs_mm(axis)

    def measured_acs_mm(self, axis: str) -> float | None:
        return self.measured.get(axis)

    def measurement_ok(self, axis: str) -> bool:
        return axis in self.measured

    def is_sercos(self, axis: str) -> bool:
        return False

    def may_measure(self, axis: str) -> bool:
        return True

    def distance_state(self, axis: str) -> str | None:
        return None

    def channel_distance(self) -> ChannelControl | None:
        return None

    def axis_numbered(self, number: int) -> str | None:
        return dict(enumerate(AXES, 1)).get(number)

    def drive_value(self, axis: str, key: str) -> float:
        raise AssertionError

    def execute(self) -> None:
        for command in self.queue:
            if isinstance(command, canon.LinearMove):
                self.acs_mm.update(command.target_mm)
            elif isinstance(command, canon.IndependentMove):
                target = self.measured.get(command.axis, command.target_mm)
                self.acs_mm[command.axis] = target
            elif isinstance(command, canon.Homing):
                self.acs_mm.update(self.homes)
        self.queue.clear()


def decode(*statements: Any, machine: Machine | None = None) -> list[canon.Command]:
    """Decode statements, block by block; every block is N10, N20, .."""
    machine = machine or Machine()
    blocks = tuple(
        ProgramBlock(Block(n, 10 * n, f"N{10 * n}"), statement)
        for n, statement in enumerate(statements, 1)
    )
    program = Program("test", "test.nc", AXES, blocks, ())
    commands = []
    for command in Interpreter(program, AXES, machine, external={}).commands():
        commands.append(command)
        machine.queue.append(command)
        if isinstance(command, canon.Wait):
            machine.execute()
    return commands


def alone(axis: str, *words: str, name: str = "INDP_SYN", **values: Any) -> AxisCommand:
    """`alone("X", "G90", "G1", POS=100, FEED=500)` is X[INDP_SYN G90 G1 POS100 FEED500]."""
    given: Mapping[str, Option] = {
        k: Name(v) if isinstance(v, str) else Number(v) for k, v in values.items()
    }
    return AxisCommand(axis, name, (*((word, None) for word in words), *given.items()))


def single(*commands: AxisCommand, **axes: float) -> Words:
    """A block of axis commands, and axis words of the path."""
    words = tuple((axis, Number(value)) for axis, value in axes.items())
    feed = (("F", Number(600.0)),) if axes else ()
    return Words(g=(), axes=words, addresses=feed, axis_commands=commands)


def path(**axes: float) -> Words:
    return single(**axes)


def moves(commands: list[canon.Command]) -> list[canon.IndependentMove]:
    return [c for c in commands if isinstance(c, canon.IndependentMove)]


def kinds(commands: list[canon.Command]) -> list[str]:
    return [type(c).__name__ for c in commands]


def measuring_type(number: int) -> Command:
    return Command("MEAS MODE", (Number(number),))
