"""Axes that move by themselves: INDP_SYN, INDP_ASYN and #WAIT INDP.

An INDP_SYN axis lets the next block wait for it. An INDP_ASYN axis moves beside the program until
#WAIT INDP, or until a block moves it (P-CHAN-00451 = 0: only if its target differs).
Sources: FCT-C4 section 2; TF5200 programming manual 208612235, P-CHAN-00451 (502430091).
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Final

from axisrig.kernel.nc import canon
from axisrig.kernel.nc.block import Block
from axisrig.kernel.nc.coordinates.stack import SAME_POSITION_MM
from axisrig.kernel.nc.decoder.axes import coupling, distance
from axisrig.kernel.nc.decoder.axes.state import forbidden, states
from axisrig.kernel.nc.decoder.axes.values import axis_named, brackets
from axisrig.kernel.nc.decoder.base.context import Context
from axisrig.kernel.nc.decoder.topics import measuring, technology
from axisrig.kernel.nc.measuring_types import measuring_types
from axisrig.kernel.nc.syntax import AxisCommand, Command, Name, Option, Words

SYNCHRONOUS: Final = "INDP_SYN"
MEASURING_TYPES: Final = (1, 2, 7)
OFFSET: Final = "G101"
MOTIONS: Final = ("G0", "G1", "G100")
DIMENSIONS: Final = ("G90", "G91")
SPEEDS: Final = {"FEED": "feed_mm_min", "TIME": "time_s", "FEED_MAX_WEIGHT": "speed_share"}
PERCENT: Final = 100.0


# ---- around the words of a block


def before_block(context: Context, block: Block, words: Words) -> Iterator[canon.Command]:
    """Refuse axes that cannot be programmed, and wait for those that must be known first."""
    known = states(context)
    # Words for distance control move nothing of their own: others may be in the same block
    commanded = [c.axis for c in words.axis_commands if c.name != distance.NAME]
    if commanded:
        named = [*commanded, *(axis for axis, _ in words.axes)]
        twice = next((axis for axis in commanded if named.count(axis) > 1), None)
        if twice is not None:
            raise context.alarm(20203, block, axis=twice)
    if known.is_plain:
        return
    measured = context.part(measuring.Measurements).beside
    controlled = [c.axis for c in words.axis_commands if c.axis in known.away]
    for axis in dict.fromkeys((*(axis for axis, _ in words.axes), *commanded, *controlled)):
        alarm = forbidden(context, block, axis)
        if alarm is not None:
            raise alarm
        # Where an axis ends that measures is not known, and a moving one cannot begin anew
        measures = axis in measured and OFFSET not in words.g
        if axis in known.under_way and (measures or axis in commanded):
            yield from _wait_for(context, block, (axis,))


def synchronised(
    context: Context, block: Block, commands: Iterable[canon.Command]
) -> Iterator[canon.Command]:
    """Let commands of the path wait for axes that they move and that are still under way.

    Raises Alarm 900195 for those that have been given away.
    """
    known = states(context)
    if known.is_plain:
        yield from commands
        return
    stood_mm = {axis: context.coordinates.acs_mm[axis] for axis in known.away}
    for command in commands:
        moved: Mapping[str, float] = getattr(command, "target_mm", {})
        # A turned system moves and measures with axes that the block does not name
        for axis, at_mm in stood_mm.items():
            is_moved = abs(moved.get(axis, at_mm) - at_mm) > SAME_POSITION_MM
            if is_moved or axis in getattr(command, "measuring_axes", ()):
                raise context.alarm(900195, block, axis=axis)
        late = tuple(axis for axis in moved if axis in known.under_way)
        if late:
            yield from _wait_for(context, block, late)
        yield command


def before_turning(context: Context, block: Block) -> Iterator[canon.Command]:
    """Let a change of the coordinate system wait for main axes that are still under way.

    A measured value belongs to the system in which its run took place (FCT-C4 section 5).
    """
    yield from wait_for_all(context, block, context.coordinates.main_axes)


def after_block(context: Context, block: Block, words: Words) -> Iterator[canon.Command]:
    """Let the next block wait for the INDP_SYN axes of this one, and follow where slaves are."""
    if states(context).active:
        coupling.lead(context)
    axes = tuple(c.axis for c in words.axis_commands if c.name == SYNCHRONOUS)
    if axes:
        yield from _wait_for(context, block, axes)


def _wait_for(context: Context, block: Block, axes: tuple[str, ...]) -> Iterator[canon.Command]:
    """Wait for axes; those that measured deliver their results."""
    known = states(context)
    yield canon.WaitIndependent(block, axes)
    for axis in axes:
        known.under_way.pop(axis, None)
    measured = [axis for axis in axes if axis in context.part(measuring.Measurements).beside]
    if measured:
        yield canon.Wait(block)
    for axis in measured:
        measuring.end_beside(context, axis)


def wait_for_all(context: Context, block: Block, axes: tuple[str, ...]) -> Iterator[canon.Command]:
    """Wait for those of the axes that are under way."""
    late = tuple(axis for axis in states(context).under_way if axis in axes)
    if late:
        yield from _wait_for(context, block, late)


def wait(context: Context, block: Block, command: Command) -> Iterator[canon.Command]:
    """#WAIT INDP [axis, ..] and #WAIT INDP ALL; without axes: all."""
    arguments = [a for bracket in brackets(command) for a in bracket.arguments]
    named = [axis for axis in (axis_named(context, a) for a in arguments) if axis is not None]
    yield from wait_for_all(context, block, tuple(named or context.axes))


# ---- the command


def move(context: Context, block: Block, command: AxisCommand) -> Iterator[canon.Command]:
    """INDP_SYN or INDP_ASYN of one axis.

    Raises Alarm 21068, 21071, 21481, 21588, 50603, 900103 and 900194; 900100 for DRY_RUN.
    """
    axis, options = command.axis, dict(command.options)
    _check(context, block, command, options)
    motion = _motion(context, block, command, options)
    measures = motion == "G100"
    measuring_type = _measuring_type(context, block, axis) if measures else None
    speed = _speed(context, block, command, options, motion, measuring_type)
    weight = _percent(context, block, axis, options, _weight_of(motion)) or 1.0
    target_mm = _target(context, block, command, options)
    yield from _announced(context, block, command)
    if target_mm is None:
        if measures:
            raise context.alarm(900103, block, axes=axis)
        return
    slope = options.get("SLOPE_TYPE")
    yield canon.IndependentMove(
        block,
        axis,
        target_mm,
        acceleration_share=weight,
        measuring_type=measuring_type,
        error_no_signal=context.part(measuring.Measurements).error_no_signal,
        slope=slope.value.upper() if isinstance(slope, Name) else None,
        **speed,
    )
    if measures:
        measuring.begin_beside(context, axis)
    states(context).under_way[axis] = None


def _check(
    context: Context, block: Block, command: AxisCommand, options: dict[str, Option]
) -> None:
    axis = command.axis
    for word, _ in command.options:
        if word[0] == "G" and word[1:].isdigit() and word not in MOTIONS + DIMENSIONS:
            raise context.alarm(21068, block, g_function=word, axis=axis)
    if context.coordinates.transformed and axis in context.coordinates.main_axes:
        raise context.alarm(21071, block, axis=axis, transformation="Cartesian")
    if axis in context.coordinates.kinematic_axes:
        raise context.alarm(21071, block, axis=axis, transformation="kinematic")
    group = states(context).group_of(axis)
    if group is not None:
        raise context.alarm(21481, block, axis=axis, group=group)


def _announced(context: Context, block: Block, command: AxisCommand) -> Iterator[canon.Command]:
    """Send the M and H functions in the bracket to the PLC side."""
    functions = tuple(k for k, _ in command.options if k[0] == "M" and k[1:].isdigit())
    h = [(k, v) for k, v in command.options if k == "H"]
    yield from technology.announce(context, block, Words(m=functions, addresses=tuple(h)))  # type: ignore[arg-type]


def _only(
    context: Context, block: Block, axis: str, found: Sequence[str], what: str, default: str
) -> str:
    if len(found) > 1:
        raise context.alarm(900194, block, axis=axis, what=f"{' and '.join(found)} at a time")
    if not found and not default:
        raise context.alarm(900194, block, axis=axis, what=f"no {what}")
    return found[0] if found else default


def _motion(
    context: Context, block: Block, command: AxisCommand, options: dict[str, Option]
) -> str:
    """G00, G01 or G100; without one the speed shows that it is G01."""
    found = [g for g in MOTIONS if g in options]
    default = "G1" if any(word in options for word in SPEEDS) else ""
    return _only(context, block, command.axis, found, "G00 or G01 or G100 or speed", default)


def _measuring_type(context: Context, block: Block, axis: str) -> int:
    type_ = measuring.measuring_type(context)
    if type_ not in MEASURING_TYPES:
        raise context.alarm(21588, block, axis=axis, type=type_)
    return type_


def _speed(
    context: Context,
    block: Block,
    command: AxisCommand,
    options: dict[str, Option],
    motion: str,
    measuring_type: int | None,
) -> dict[str, float]:
    """The one speed of the command; none in rapid traverse and where the type has its own."""
    axis = command.axis
    found = [word for word in SPEEDS if word in options]
    if motion == "G0":
        if found:
            raise context.alarm(50603, block, axis=axis, option=f"{found[0]} with G00")
        return {}
    if measuring_type is not None and measuring_types()[measuring_type].has_own_speed:
        return {}
    word = _only(context, block, axis, found, "FEED or TIME or FEED_MAX_WEIGHT", "")
    if word == "FEED_MAX_WEIGHT":
        share = _percent(context, block, axis, options, word)
        assert share is not None
        return {SPEEDS[word]: share}
    value = _number(context, block, options[word])
    if value <= 0.0:
        raise context.alarm(50603, block, axis=axis, option=f"{word}={value:g}")
    return {SPEEDS[word]: context.mm(axis, value) if word == "FEED" else value}


def _weight_of(motion: str) -> str:
    return "RAPID_ACC_WEIGHT" if motion == "G0" else "ACC_WEIGHT"


def _percent(
    context: Context, block: Block, axis: str, options: dict[str, Option], word: str
) -> float | None:
    """The share of 1 that a weight in percent means; None without the keyword."""
    if word not in options:
        return None
    value = _number(context, block, options[word])
    if not 0.0 < value <= PERCENT:
        raise context.alarm(50603, block, axis=axis, option=f"{word}={value:g}")
    return value / PERCENT


def _number(context: Context, block: Block, option: Option) -> float:
    assert option is not None
    assert not isinstance(option, Name)
    return context.value(block, option)  # type: ignore[arg-type]


def _target(
    context: Context, block: Block, command: AxisCommand, options: dict[str, Option]
) -> float | None:
    """Where the axis goes, axis coordinates; None when it is there.

    Without INCL_OFFSETS the programmed position is an axis position: no shift counts.
    """
    axis, coordinates = command.axis, context.coordinates
    if "POS" not in options:
        raise context.alarm(900194, block, axis=axis, what="no POS")
    default = "G90" if context.modal.absolute else "G91"
    found = [g for g in DIMENSIONS if g in options]
    absolute = _only(context, block, axis, found, "G90 or G91", default) == "G90"
    value_mm = context.mm(axis, _number(context, block, options["POS"]))
    if "INCL_OFFSETS" in options:
        aimed = coordinates.aim({axis: value_mm}, absolute=absolute)
        return aimed.get(axis)
    here_mm = coordinates.acs_mm[axis]
    target_mm = value_mm if absolute else here_mm + value_mm
    return target_mm if coordinates.aim({axis: target_mm - here_mm}, absolute=False) else None
