"""What the call of a cycle keeps for its caller: the modal state, given back at the end."""

from collections.abc import Callable
from dataclasses import replace

from axisrig.kernel.nc.decoder.base.context import Context
from axisrig.kernel.nc.decoder.topics.circles import Circle
from axisrig.kernel.nc.decoder.topics.pauses import BlockEnds


def restoring(context: Context) -> Callable[[], None] | None:
    """Return what gives the caller of a cycle its modal state back; None with P-CHAN-00210 = 1.

    Given back are G functions that stand alone (motion, G90/G91, G70/G71, plane, G53 to G59, G161
    to G165, G260/G261, G359/G360), what is kept of circles, and the feed. What comes with a value
    or with axes (G92, G101, G130, G159) stays. Source: TF5200 channel parameters 476043659.
    """
    if context.tables.cycle_changes_modal:
        return None
    modal = replace(context.modal)
    circle, ends = replace(context.part(Circle)), replace(context.part(BlockEnds))
    plane, zero_group = context.coordinates.plane, context.coordinates.zero_group

    def restore() -> None:
        if context.modal.zero_group != modal.zero_group:
            context.select_zero(zero_group)
        context.modal = modal
        ends.rounds = context.part(BlockEnds).rounds  # of the last block of motion, not modal
        context.keep(circle)
        context.keep(ends)
        context.coordinates.plane = plane

    return restore
