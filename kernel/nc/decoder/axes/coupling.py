"""Axis couplings: #SET AX LINK, #ENABLE AX LINK and #DISABLE AX LINK, #AX LINK in all its forms.

A coupling group is a set of slave=master pairs; with G a pair is a gantry, whose actual positions
may come apart by two limits in mm. Couplings end with the program. Sources: TF5200 programming
manual 207120267 and 207133579, ISG 285662475.
"""

from collections.abc import Iterable, Iterator
from typing import Final

from kernel.nc import canon
from kernel.nc.canon import AxisPair, Block
from kernel.nc.decoder.axes.state import AxisStates, states
from kernel.nc.decoder.axes.values import brackets, number, shown, whole
from kernel.nc.decoder.context import Context
from kernel.nc.syntax import Argument, Command, Group, Name, Option

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
    pairs = tuple(_pairs(context, block, bracket))
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


def _pairs(context: Context, block: Block, bracket: Group) -> Iterator[AxisPair]:
    for slave, master in bracket.options:
        yield _pair(context, block, slave, master)
    for argument in bracket.arguments[1:]:
        if not isinstance(argument, Group) or len(argument.options) != 1:
            written = shown(context, block, argument)
            raise context.alarm(900198, block, value=written, what="no slave=master")
        ((slave, master),) = argument.options
        limits = _limits(context, block, slave, argument.arguments)
        yield _pair(context, block, slave, master, limits)


def _pair(
    context: Context,
    block: Block,
    slave: str,
    master: Option,
    limits_mm: tuple[float, float] | None = None,
) -> AxisPair:
    names = {axis.upper(): axis for axis in context.axes}
    pair = f"{slave}={shown(context, block, master)}"
    if not isinstance(master, Name) or not {slave.upper(), master.value.upper()} <= names.keys():
        raise context.alarm(900198, block, value=pair, what="the channel has no such axis")
    return AxisPair(names[slave.upper()], names[master.value.upper()], limits_mm)


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
        raise context.alarm(900198, block, value=slave, what="G and two limits belong behind it")
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
    """#ENABLE AX LINK [group]; raises Alarm 20467, 21283 to 21285, 900195 and 900197."""
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
    """Let the slaves stand where the block has led them."""
    known, coordinates = states(context), context.coordinates
    slaves = {
        pair.slave: coordinates.acs_mm[pair.master] + known.offsets_mm[pair.slave]
        for _, pair in known.pairs()
    }
    coordinates.stand_at(slaves)


def _check_free(context: Context, block: Block, known: AxisStates, pair: AxisPair) -> None:
    if pair.slave in context.coordinates.main_axes:
        raise context.alarm(20467, block, axis=pair.slave)
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
        context.coordinates.stand_at({axis: at(axis) for axis in slaves})


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
