"""Kinematic transformations: #KIN ID chooses, #TRAFO switches (docs/kinematics.md).

The tool is taken in when the transformation is switched on. Sources: FCT-M3 12.2 and 12.4; TF5200
programming manual 1133884683.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field

from axisrig.kernel.kinematics import (
    Kinematic,
    build,
    check_axes,
    check_known,
    kinematic_types,
)
from axisrig.kernel.nc import canon
from axisrig.kernel.nc.block import Block
from axisrig.kernel.nc.decoder import axes
from axisrig.kernel.nc.decoder.base.context import Context
from axisrig.kernel.nc.decoder.base.topic import Topic
from axisrig.kernel.nc.expressions import Value, whole_number
from axisrig.kernel.nc.syntax import Command, Expression

TOOL_WITH_OFFSETS = 900480
READ_OTHERWISE = 900484
UNKNOWN = 292005
PARAMETER = "V.G.KIN_STEP[].ID[].PARAM[]"
STEPS, PARAMETERS = 2, 74


@dataclass
class Kinematics:
    """What a program says of kinematics.

    chosen: IDs of #KIN ID, none for those of the channel. written: V.G.KIN_STEP[].ID[].PARAM[] by
    its three indices, in 0.1 um and 0.0001 degrees.
    """

    chosen: tuple[int, ...] = ()
    written: dict[tuple[int, ...], float] = field(default_factory=dict)


def _choose(context: Context, block: Block, command: Command) -> Iterator[canon.Command]:
    """#KIN ID; raises Alarm 292005 and 900440 for what cannot be switched on."""
    numbers = _numbers(context, block, command)
    check_known(numbers, context.tables.kinematics)
    context.part(Kinematics).chosen = numbers
    yield from _warning(context, block, command)


def _warning(context: Context, block: Block, command: Command) -> Iterator[canon.Command]:
    if command.remark:
        yield canon.Warn(block, context.alarm(READ_OTHERWISE, block, remark=command.remark))


def _on(context: Context, block: Block, command: Command) -> Iterator[canon.Command]:
    """#TRAFO ON with what was chosen, #TRAFO[..] with what it names.

    Raises Alarm 900480 for a tool with axis offsets, 900195 and 900196 for an axis of the kinematic
    that is away or follows another, and those of the kinematic.
    """
    kept = context.part(Kinematics)
    known = context.tables.kinematics
    numbers = _numbers(context, block, command) or kept.chosen or known.default_ids
    offsets = {
        context.axes[place]: offset_mm
        for place, offset_mm in context.coordinates.tool.offsets_mm.items()
        if offset_mm
    }
    if offsets:
        raise context.alarm(TOOL_WITH_OFFSETS, block, axes=" ".join(offsets))
    tool_mm = context.coordinates.tool.length_mm
    kinematic = build(numbers, known, kept.written, tool_mm)
    check_axes(kinematic, [(axis, axis in context.tables.rotary) for axis in context.axes])
    inside = tuple(context.axes[: kinematic.count])
    for axis in inside:
        alarm = axes.forbidden(context, block, axis)
        if alarm is not None:
            raise alarm
    yield from _warning(context, block, command)
    yield from axes.wait_for_all(context, block, inside)
    yield from _switch(context, block, kinematic)
    yield canon.KinematicChoice(block, kinematic, inside, numbers, tool_mm, dict(kept.written))


def _switch(context: Context, block: Block, kinematic: Kinematic | None) -> Iterator[canon.Command]:
    """Let the machine come to rest, and begin in the new coordinates where it is then.

    Raises Alarm 51062 while the offset of 3D distance control changes.
    """
    yield from axes.turns_channel(context, block, "#TRAFO")
    yield from axes.before_turning(context, block)
    yield canon.Wait(block)
    at = context.machine.position_acs_mm
    coordinates = context.coordinates
    coordinates.use_kinematic(kinematic, {axis: at(axis) for axis in context.axes})


def _numbers(context: Context, block: Block, command: Command) -> tuple[int, ...]:
    return tuple(
        _number(context, block, step, argument)
        for step, argument in enumerate(command.arguments)
        if isinstance(argument, Expression)
    )


def _number(context: Context, block: Block, step: int, argument: Expression) -> int:
    value = context.value(block, argument)
    number = whole_number(value)
    if number is None:
        known = ", ".join(str(key) for key, row in kinematic_types().items() if row.acts)
        raise context.alarm(UNKNOWN, block, id=f"{value:.10g}", step=step, known=known)
    return number


def _off(context: Context, block: Block, command: Command) -> Iterator[canon.Command]:
    """#TRAFO OFF; nothing where none is on."""
    if context.coordinates.kinematic is not None:
        yield from _switch(context, block, None)
        yield canon.KinematicChoice(block, None)


def _check_indices(context: Context, block: Block, step: int, parameter: int) -> None:
    for index, count in ((step, STEPS), (parameter, PARAMETERS)):
        if not 0 <= index < count:
            raise context.index_alarm(block, PARAMETER, index, count - 1)


def _read(context: Context, block: Block, rest: str, *indices: int) -> Value:
    _check_indices(context, block, indices[0], indices[-1])
    return context.part(Kinematics).written.get(indices, 0.0)


def _write(
    context: Context, block: Block, rest: str, value: Value, *indices: int
) -> Iterator[canon.Command]:
    _check_indices(context, block, indices[0], indices[-1])
    context.part(Kinematics).written[indices] = context.number(block, value)
    return iter(())


TOPIC = Topic(
    commands={
        "KIN ID": _choose,
        "TRAFO": _on,
        "TRAFO ON": _on,
        "TRAFO OFF": _off,
    },
    readers={PARAMETER: _read},
    writers={PARAMETER: _write},
)
