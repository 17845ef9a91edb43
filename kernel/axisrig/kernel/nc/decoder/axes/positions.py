"""#CHANNEL INIT: the channel takes over where its axes are.

ACTPOS makes actual positions of axes at rest their set positions, so that the axes move by what
they lagged; for axes that are not named the set positions count, and as these must be at rest, axes
under way are waited for (P-CHAN-00455 = 0). CMDPOS takes the set positions. Sources: TF5200
programming manual 206703627 and 206709515, channel parameters 1012527499.
"""

from collections.abc import Iterator

from axisrig.kernel.nc import canon
from axisrig.kernel.nc.block import Block
from axisrig.kernel.nc.decoder.axes import distance
from axisrig.kernel.nc.decoder.axes.independent import wait_for_all
from axisrig.kernel.nc.decoder.axes.state import states
from axisrig.kernel.nc.decoder.axes.values import axis_named
from axisrig.kernel.nc.decoder.base.context import Context
from axisrig.kernel.nc.syntax import Command, Expression, Option


def initialise(context: Context, block: Block, command: Command) -> Iterator[canon.Command]:
    """#CHANNEL INIT [CMDPOS|ACTPOS {AX=name | AXNR=number}]; raises Alarm 20312 for a number.

    ACTPOS raises Alarm 51062 while the distance control of an axis is on, both while 3D control is.
    """
    known = states(context)
    actual = command.has("ACTPOS")
    present = [axis for axis in context.axes if axis not in known.away]
    named = [_axis(context, block, k, v) for k, v in command.options if k in ("AX", "AXNR")]
    axes = named or present
    yield from wait_for_all(context, block, tuple(present if actual else axes))
    yield from distance.turns_channel(context, block, "#CHANNEL INIT")
    if actual:
        yield from distance.initialises(context, block, axes, "#CHANNEL INIT[ACTPOS]")
        slaves = {pair.slave for _, pair in known.pairs()}
        yield canon.AdoptActual(block, tuple(axis for axis in axes if axis not in slaves))
    yield canon.Wait(block)
    at = context.machine.position_acs_mm
    context.coordinates.begin_at({axis: at(axis) for axis in (present if actual else axes)})


def _axis(context: Context, block: Block, keyword: str, value: Option) -> str:
    if keyword == "AX":
        axis = axis_named(context, value)
        assert axis is not None, "the text has been checked for axes of the rig"
        return axis
    assert isinstance(value, Expression), "the table of commands has checked it"
    return context.numbered_axis(block, value)
