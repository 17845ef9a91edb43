"""G74: axes look for their reference in a programmed order.

Source: TF5200 programming manual 206138635: `G74 X2 Y3 Z1` homes Z, then X, then Y; axes with one
number home at the same time.
"""

from collections.abc import Iterator
from typing import Final

from axisrig.kernel.nc import canon
from axisrig.kernel.nc.block import Block
from axisrig.kernel.nc.decoder.axes import distance
from axisrig.kernel.nc.decoder.axes.independent import wait_for_all
from axisrig.kernel.nc.decoder.axes.state import states
from axisrig.kernel.nc.decoder.base.context import Context
from axisrig.kernel.nc.expressions import whole_number
from axisrig.kernel.nc.syntax import Words

LOW: Final = 1
HIGH: Final = 65535


def home(context: Context, block: Block, words: Words) -> Iterator[canon.Command]:
    """Home the axes of the block; afterwards the channel starts from where they are.

    Raises Alarm 20137 while a coupling is on, 20816 for a number that is no place in an order,
    51062 while the distance control of an axis is on.
    """
    known = states(context)
    context.require_free(block, (axis for axis, _ in words.axes), "G74")
    if known.active:
        raise context.alarm(20137, block, g_function="G74", group=known.active[-1])
    order = {}
    for axis, expression in words.axes:
        value = context.value(block, expression)
        place = whole_number(value)
        if place is None or not LOW <= place <= HIGH:
            shown = f"{value:.10g}"
            raise context.alarm(20816, block, axis=axis, value=shown, low=LOW, high=HIGH)
        order[axis] = place
    groups = tuple(
        tuple(axis for axis, at in order.items() if at == place)
        for place in sorted(set(order.values()))
    )
    yield from wait_for_all(context, block, tuple(context.axes))
    yield from distance.initialises(context, block, order, "G74")
    yield canon.Homing(block, groups)
    yield canon.Wait(block)
    at = context.machine.position_acs_mm
    context.coordinates.begin_at({axis: at(axis) for axis in order})
