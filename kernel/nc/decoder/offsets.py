"""Shifts of the coordinates of single axes, the working plane, the unit, and their variables."""

from collections.abc import Callable

from kernel.nc.canon import Block
from kernel.nc.coordinates import Coordinates
from kernel.nc.coordinates.places import PLANES
from kernel.nc.decoder.context import Context
from kernel.nc.decoder.topic import Handler, Reader, Topic, silent
from kernel.nc.syntax import Words

# G53 is group 0 of the zero offsets, G54 to G59 are 1 to 6. TF5200 zero offsets 103721099
ZERO_OFFSETS = {f"G{53 + group}": group for group in range(7)}


def _reference_point(context: Context, block: Block, words: Words) -> None:
    added = not context.modal.absolute
    for axis, shift_mm in context.axis_values(block, words).items():
        context.coordinates.shift_reference(axis, shift_mm, added=added)


def _zero_offset(group: int) -> Handler:
    return silent(lambda context, block, words: context.select_zero(group))


def _choose_plane(g: str) -> Handler:
    def choose(context: Context, block: Block, words: Words) -> None:
        context.coordinates.plane = PLANES[g]

    return silent(choose)


def _choose_unit(inch: bool) -> Handler:
    def choose(context: Context, block: Block, words: Words) -> None:
        context.modal.inch = inch

    return silent(choose)


def _of_axis(value_of: Callable[[Coordinates, str], float]) -> Reader:
    def reader(context: Context, block: Block, upper: str) -> float:
        axis = context.axis(upper)
        return context.shown(axis, value_of(context.coordinates, axis))

    return reader


def _unit(context: Context, block: Block, rest: str) -> float:
    return float(context.modal.inch)


def _default_group(context: Context, block: Block, rest: str) -> float:
    return float(context.zero_offsets.default_group)


TOPIC = Topic(
    settings={
        **{g: _zero_offset(group) for g, group in ZERO_OFFSETS.items()},
        **{g: _choose_plane(g) for g in PLANES},
        "G70": _choose_unit(True),
        "G71": _choose_unit(False),
    },
    takes_axes={"G92": silent(_reference_point)},
    readers={
        "V.A.PROG": _of_axis(Coordinates.programmed_mm),
        "V.A.ABS": _of_axis(Coordinates.absolute_mm),
        "V.A.ACS.ABS": _of_axis(lambda coordinates, axis: coordinates.acs_mm[axis]),
        "V.A.BZP": _of_axis(lambda coordinates, axis: coordinates.shifts(axis).reference_mm),
        "V.G.MASS_MM": _unit,
        "V.G.NP_DEFAULT": _default_group,
    },
)
