"""Axis exchange: #PUT AX gives axes away, #CALL AX takes them back.

The rig has one channel, so an axis that is given away goes nowhere: its drive holds it, and the
program cannot move it until it is called back. Sources: TF5200 programming manual 206995083 and
206987659.
"""

from collections.abc import Callable, Iterator
from typing import Final

from axisrig.kernel.errors import Alarm
from axisrig.kernel.nc import canon
from axisrig.kernel.nc.block import Block
from axisrig.kernel.nc.decoder.axes import distance
from axisrig.kernel.nc.decoder.axes.independent import wait_for_all
from axisrig.kernel.nc.decoder.axes.state import states
from axisrig.kernel.nc.decoder.axes.values import axis_named, brackets, shown, whole
from axisrig.kernel.nc.decoder.base.context import Context
from axisrig.kernel.nc.syntax import Command, Group, Name


def _coupled(context: Context, block: Block, axis: str) -> Alarm | None:
    group = states(context).group_of(axis)
    return None if group is None else context.alarm(20545, block, axis=axis, group=group)


# What forbids to give an axis away
FORBIDS: Final[tuple[Callable[[Context, Block, str], Alarm | None], ...]] = (
    _coupled,
    distance.must_stay,
)


def put(context: Context, block: Block, command: Command) -> Iterator[canon.Command]:
    """#PUT AX [axis, ..] and #PUT AX ALL; axes that were given away already are no error.

    Raises Alarm 20545, 70333 and 900482.
    """
    known = states(context)
    named = [a for bracket in brackets(command) for a in bracket.arguments]
    is_all = command.has("ALL") or (
        len(named) == 1 and isinstance(named[0], Name) and named[0].value.upper() == "ALL"
    )
    axes = list(context.axes) if is_all else [axis_named(context, a) for a in named]
    given = tuple(a for a in dict.fromkeys(axes) if a is not None and a not in known.away)
    context.require_free(block, given, "#PUT AX")
    yield from distance.known_states(context, block, given)
    for axis in given:
        for forbids in FORBIDS:
            alarm = forbids(context, block, axis)
            if alarm is not None:
                raise alarm
    if given:
        yield from wait_for_all(context, block, given)
        yield canon.AxisExchange(block, given, ())
        known.away.update(given)


def call(context: Context, block: Block, command: Command) -> Iterator[canon.Command]:
    """#CALL AX [FAST] [axis, logical number, index] ..; axes in the channel are not called again.

    The channel is initialised where the axes are, FAST or not. Raises Alarm 20312, 21256 to
    21258, 21260, 21261 and 900199; 900100 for options of the exchange.
    """
    known = states(context)
    wanted = [_wanted(context, block, bracket) for bracket in brackets(command)]
    for place, alarm_id, word in ((0, 21256, "axis"), (1, 21258, "number"), (2, 21257, "index")):
        values = [str(entry[place]).upper() for entry in wanted if entry[place] is not None]
        twice = next((v for v in values if values.count(v) > 1), None)
        if twice is not None:
            raise context.alarm(alarm_id, block, **{word: twice})
    called = []
    for name, number, index in wanted:
        axis = context.machine.axis_numbered(number)
        if axis is None:
            raise context.alarm(20312, block, number=number)
        if axis in known.away:
            _check_place(context, block, axis, name, index)
            called.append(axis)
    if called:
        yield canon.AxisExchange(block, (), tuple(called))
        yield canon.Wait(block)
        at = context.machine.position_acs_mm
        context.coordinates.begin_at({axis: at(axis) for axis in called})
        known.away.difference_update(called)


def _wanted(context: Context, block: Block, bracket: Group) -> tuple[str, int, int | None]:
    name, number, index, *more = (*bracket.arguments, *(None,) * 3)
    written, found = shown(context, block, name), whole(context, block, number)
    if found is None:
        raise context.alarm(20312, block, number=shown(context, block, number))
    if any(option is not None for option in more) or bracket.options:
        raise context.not_acting(block, "options of #CALL AX", "offsets taken over")
    place = whole(context, block, index)
    if index is not None and (place is None or place < 0):
        what = f"axis index ({shown(context, block, index)})"
        raise context.alarm(900199, block, axis=written, what=what)
    return written, found, place


def _check_place(context: Context, block: Block, axis: str, name: str, index: int | None) -> None:
    """Refuse another name or place than the rig has for an axis."""
    away = states(context).away
    if name.upper() != axis.upper():
        others = {other.upper() for other in context.axes if other not in away}
        if name.upper() in others:
            raise context.alarm(21261, block, axis=name)
        raise context.alarm(900199, block, axis=axis, what=f"name ({name})")
    if index is not None and index != list(context.axes).index(axis):
        if index < len(context.axes) and context.axes[index] not in away:
            raise context.alarm(21260, block, index=index)
        raise context.alarm(900199, block, axis=axis, what=f"axis index ({index})")
