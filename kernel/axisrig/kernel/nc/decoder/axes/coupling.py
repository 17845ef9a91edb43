"""Axis couplings: #SET AX LINK, #ENABLE AX LINK and #DISABLE AX LINK, #AX LINK in all its forms.

A coupling group is a set of slave=master pairs; with G a pair is a gantry, whose actual positions
may come apart by two limits in mm. Couplings end with the program. Sources: TF5200 programming
manual 207120267 and 207133579, ISG 285662475.
"""

from collections.abc import Callable, Iterable, Iterator
from typing import Final

from axisrig.kernel.nc import canon
from axisrig.kernel.nc.block import Block
from axisrig.kernel.nc.canon import AxisPair
from axisrig.kernel.nc.decoder.axes.state import AxisStates, states
from axisrig.kernel.nc.decoder.axes.values import axis_named, brackets, number, shown, whole
from axisrig.kernel.nc.decoder.base.context import Context
from axisrig.kernel.nc.syntax import Argument, Command, Group, Name, Option

Finder = Callable[[Context, Block, str, Option], tuple[str, str] | None]

GROUP_MAX: Final = 31
GANTRY: Final = "G"


def define(context: Context, block: Block, command: Command) -> Iterator[canon.Command]:
    """#SET AX LINK [group, slave=master, [slave=master, G, limit, limit], ..]; gives no command.

    Raises Alarm 20472, 20475, 20476, 20477, 900197 and 900198.
    """
    known, (bracket,) = states(context), brackets(command)
    group = _group(context, block, bracket)
    if group in known.active:
        raise context.alarm(20472, block, group=group)
    finds = _by_number if command.has("NBR") else _by_name
    pairs = tuple(_pairs(context, block, bracket, finds))
    if not pairs:
        raise context.alarm(900197, block, group=group, what="has no pair of axes")
    _check(context, block, group, pairs)
    known.groups[group] = pairs
    yield from ()


def _group(context: Context, block: Block, bracket: Group) -> int:
    first = bracket.arguments[0] if bracket.arguments else None
    group = whole(context, block, first)
    if group is None or not 1 <= group <= GROUP_MAX:
        written = shown(context, block, first)
        raise context.alarm(900197, block, group=written, what="cannot be defined")
    return group


def _pairs(context: Context, block: Block, bracket: Group, finds: Finder) -> Iterator[AxisPair]:
    entries: list[tuple[tuple[str, Option], tuple[float, float] | None]]
    entries = [(option, None) for option in bracket.options]
    for argument in bracket.arguments[1:]:
        if not isinstance(argument, Group) or len(argument.options) != 1:
            written = shown(context, block, argument)
            raise context.alarm(900198, block, value=written, what="no slave=master")
        (option,) = argument.options
        entries.append((option, _limits(context, block, option[0], argument.arguments)))
    for (slave, master), limits_mm in entries:
        found = finds(context, block, slave, master)
        if found is None:
            pair = f"{slave}={shown(context, block, master)}"
            raise context.alarm(900198, block, value=pair, what="the channel has no such axis")
        yield AxisPair(*found, limits_mm)


def _by_name(context: Context, block: Block, slave: str, master: Option) -> tuple[str, str] | None:
    """The axes of a pair of names; None when one of them is not there."""
    first, second = axis_named(context, Name(slave)), axis_named(context, master)
    return None if first is None or second is None else (first, second)


def _by_number(
    context: Context, block: Block, slave: str, master: Option
) -> tuple[str, str] | None:
    """The axes of a pair of logical numbers (NBR)."""
    axis = context.machine.axis_numbered
    number = whole(context, block, master)
    first = axis(int(slave)) if slave.isdecimal() else None
    second = None if number is None else axis(number)
    return None if first is None or second is None else (first, second)


def _limits(
    context: Context, block: Block, slave: str, arguments: Iterable[Argument]
) -> tuple[float, float] | None:
    """The limits of a gantry; without them it is not watched."""
    keyword, *values = arguments or (None,)
    if (
        not isinstance(keyword, Name)
        or keyword.value.upper() != GANTRY
        or len(values) not in (0, 2)
    ):
        raise context.alarm(900198, block, value=slave, what="G and two limits belong after it")
    numbers = [number(context, block, value) for value in values]
    if not numbers:
        return None
    if None in numbers:
        raise context.alarm(900198, block, value=slave, what="limits are numbers")
    first_mm, second_mm = numbers
    assert first_mm is not None
    assert second_mm is not None
    if not 0.0 < first_mm <= second_mm:
        both = f"{first_mm:g}, {second_mm:g}"
        raise context.alarm(900198, block, value=both, what="limits rise and are above 0")
    return first_mm, second_mm


def _check(context: Context, block: Block, group: int, pairs: tuple[AxisPair, ...]) -> None:
    masters = {pair.master for pair in pairs}
    slaves: set[str] = set()
    for place, pair in enumerate(pairs):
        if pair.slave == pair.master:
            raise context.alarm(20475, block, axis=pair.slave, pair=place, group=group)
        if pair.slave in slaves:
            raise context.alarm(20476, block, axis=pair.slave)
        slaves.add(pair.slave)
    both = sorted(masters & slaves)
    if both:
        raise context.alarm(20477, block, axis=both[0])


def switch_on(context: Context, block: Block, command: Command) -> Iterator[canon.Command]:
    """#ENABLE AX LINK [group].

    Raises Alarm 20467, 21283 to 21285, 900195, 900197 and 900482.
    """
    known = states(context)
    group = _chosen(context, block, command)
    if group is None or group not in known.groups:
        raise context.alarm(900197, block, group=group or 0, what="is not defined")
    if group in known.active:
        return
    pairs = known.groups[group]
    for pair in pairs:
        _check_free(context, block, known, pair)
    yield canon.AxisLinkOn(block, group, pairs)
    known.active.append(group)
    at_mm = context.coordinates.acs_mm
    known.offsets_mm.update({p.slave: at_mm[p.slave] - at_mm[p.master] for p in pairs})


def lead(context: Context) -> None:
    """Leave the slaves where the block has led them."""
    known, coordinates = states(context), context.coordinates
    slaves = {
        pair.slave: coordinates.acs_mm[pair.master] + known.offsets_mm[pair.slave]
        for _, pair in known.pairs()
    }
    coordinates.stand_at(slaves)


def _check_free(context: Context, block: Block, known: AxisStates, pair: AxisPair) -> None:
    if pair.slave in context.coordinates.main_axes:
        raise context.alarm(20467, block, axis=pair.slave)
    context.require_free(block, (pair.slave,), "#ENABLE AX LINK")
    for axis in (pair.slave, pair.master):
        if axis in known.away:
            raise context.alarm(900195, block, axis=axis)
    for group, other in known.pairs():
        for axis, used, alarm_id in (
            (pair.slave, other.slave, 21283),
            (pair.slave, other.master, 21284),
            (pair.master, other.slave, 21285),
        ):
            if axis == used:
                raise context.alarm(alarm_id, block, axis=axis, group=group)


def switch_off(context: Context, block: Block, command: Command) -> Iterator[canon.Command]:
    """#DISABLE AX LINK [group], without one the group switched on last; #AX LINK OFF ALL."""
    known = states(context)
    if command.has("ALL") or any(isinstance(a, Name) for a in command.arguments):
        groups = list(reversed(known.active))
    else:
        chosen = _chosen(context, block, command)
        groups = known.active[-1:] if chosen is None else [chosen]
    slaves: list[str] = []
    for group in groups:
        if group not in known.active:
            raise context.alarm(900197, block, group=group, what="is not on")
        yield canon.AxisLinkOff(block, group)
        known.active.remove(group)
        slaves += [pair.slave for pair in known.groups[group]]
    if slaves:
        yield canon.Wait(block)
        at = context.machine.position_acs_mm
        context.coordinates.begin_at({axis: at(axis) for axis in slaves})


def _chosen(context: Context, block: Block, command: Command) -> int | None:
    """The group in the bracket; None without one."""
    arguments = [a for bracket in brackets(command) for a in bracket.arguments]
    if not arguments:
        return None
    group = whole(context, block, arguments[0])
    if group is None:
        written = shown(context, block, arguments[0])
        raise context.alarm(900197, block, group=written, what="is no whole number")
    return group
