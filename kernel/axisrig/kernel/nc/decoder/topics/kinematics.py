"""Kinematic transformations (#TRAFO, #KIN ID): the choice is kept, none is carried out."""

from collections.abc import Iterator
from dataclasses import dataclass, field

from axisrig.kernel.nc import canon
from axisrig.kernel.nc.canon import Block
from axisrig.kernel.nc.decoder.base.context import Context
from axisrig.kernel.nc.decoder.base.topic import Topic, silent
from axisrig.kernel.nc.expressions import Value
from axisrig.kernel.nc.syntax import Command, Expression


@dataclass
class Kinematics:
    """chosen: IDs of #KIN ID. parameters: V.G.KIN_STEP[].ID[].PARAM[] by its three indices."""

    chosen: tuple[int, ...] = ()
    parameters: dict[tuple[int, ...], Value] = field(default_factory=dict)


def _choose(context: Context, block: Block, command: Command) -> None:
    context.part(Kinematics).chosen = _numbers(context, block, command)


def _activate(context: Context, block: Block, command: Command) -> None:
    numbers = _numbers(context, block, command) or context.part(Kinematics).chosen
    names = ", ".join(map(str, numbers)) or "of P-CHAN-00032"
    raise context.not_acting(block, f"#{command.name}", f"kinematic {names}")


def _numbers(context: Context, block: Block, command: Command) -> tuple[int, ...]:
    return tuple(
        round(context.value(block, argument))
        for argument in command.arguments
        if isinstance(argument, Expression)
    )


def _off(context: Context, block: Block, command: Command) -> None:
    """#TRAFO OFF where none is on."""


def _read(context: Context, block: Block, rest: str, *indices: int) -> Value:
    return context.part(Kinematics).parameters.get(indices, 0.0)


def _write(
    context: Context, block: Block, rest: str, value: Value, *indices: int
) -> Iterator[canon.Command]:
    context.part(Kinematics).parameters[indices] = value
    return iter(())


PARAMETER = "V.G.KIN_STEP[].ID[].PARAM[]"
TOPIC = Topic(
    commands={
        "KIN ID": silent(_choose),
        "TRAFO": silent(_activate),
        "TRAFO ON": silent(_activate),
        "TRAFO OFF": silent(_off),
    },
    readers={PARAMETER: _read},
    writers={PARAMETER: _write},
)
