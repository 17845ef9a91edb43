"""Shifts of the coordinates of single axes."""

from kernel.nc.canon import Block
from kernel.nc.decoder.context import Context
from kernel.nc.decoder.topic import Topic, silent
from kernel.nc.syntax import Words


def _reference_point(context: Context, block: Block, words: Words) -> None:
    added = not context.modal.absolute
    for axis, shift_mm in context.axis_values(block, words).items():
        context.coordinates.shift_reference(axis, shift_mm, added=added)


def _programmed_mm(context: Context, block: Block, axis: str) -> float:
    return context.coordinates.programmed_mm(context.axis(axis))


def _absolute_mm(context: Context, block: Block, axis: str) -> float:
    return context.coordinates.absolute_mm(context.axis(axis))


TOPIC = Topic(
    takes_axes={"G92": silent(_reference_point)},
    readers={"V.A.PROG": _programmed_mm, "V.A.ABS": _absolute_mm},
)
