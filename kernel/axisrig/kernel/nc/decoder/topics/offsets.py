"""Shifts of the coordinates of single axes, the working plane, the unit, and their variables."""

from collections.abc import Callable, Iterator

from axisrig.kernel.nc import canon
from axisrig.kernel.nc.block import Block
from axisrig.kernel.nc.coordinates import Coordinates
from axisrig.kernel.nc.coordinates.places import PLANES
from axisrig.kernel.nc.coordinates.zero_offsets import GROUPS
from axisrig.kernel.nc.decoder.base.context import Context
from axisrig.kernel.nc.decoder.base.topic import Handler, Reader, Topic, silent
from axisrig.kernel.nc.expressions import Value, whole_number
from axisrig.kernel.nc.syntax import Words

# G53 is group 0 of the zero offsets, G54 to G59 are 1 to 6. TF5200 zero offsets 103721099
ZERO_OFFSETS = {f"G{53 + group}": group for group in range(7)}


def _reference_point(context: Context, block: Block, words: Words) -> None:
    added = not context.modal.absolute
    for axis, shift_mm in context.axis_values(block, words).items():
        context.coordinates.shift_reference(axis, shift_mm, added=added)


def _zero_offset(group: int) -> Handler:
    def choose(context: Context, block: Block, words: Words) -> None:
        context.modal.zero_group = group
        context.select_zero(group)

    return silent(choose)


def _numbered_offset(context: Context, block: Block, words: Words) -> None:
    """G159 = group: every group of the list, also after G59. TF5200 zero offsets 103721099."""
    expression = words.address("G159")
    assert expression is not None, "checked by the parser"
    index = _whole_group(context, block, context.value(block, expression), "G159")
    context.select_zero(_group(context, block, index, "G159"))


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


def _actual(context: Context, block: Block, upper: str) -> float:
    """V.A.ACT_POS: the actual position in the active system without shifts."""
    axis, machine = context.axis(upper), context.machine
    asked = {axis, *context.coordinates.common_axes}
    actual = {name: machine.actual_acs_mm(name) for name in asked}
    return context.shown(axis, context.coordinates.without_shifts_mm(actual, axis))


def _unit(context: Context, block: Block, rest: str) -> float:
    return float(context.modal.inch)


def _default_group(context: Context, block: Block, rest: str) -> float:
    return float(context.zero_offsets.default_group)


def _choose_default(
    context: Context, block: Block, rest: str, value: Value
) -> Iterator[canon.Command]:
    """V.G.NP_DEFAULT: for the next program of the same list, which no run has."""
    index = _whole_group(context, block, context.number(block, value), "V.G.NP_DEFAULT")
    context.zero_offsets.default_group = _group(context, block, index, "V.G.NP_DEFAULT")
    return iter(())


def _whole_group(context: Context, block: Block, value: float, name: str) -> int:
    index = whole_number(value)
    if index is None:
        raise context.alarm(900105, block, reason=f"{name} = {value:.10g} is no group")
    return index


def _group(context: Context, block: Block, index: int, name: str = "V.G.NP[]") -> int:
    if not 0 <= index < GROUPS:
        raise context.index_alarm(block, name, index, GROUPS - 1)
    return index


def _read_group(context: Context, block: Block, rest: str, group: int, *indices: int) -> float:
    axis = context.indexed_axis(block, rest, list(indices))
    place = _group(context, block, group), context.axes.index(axis)
    return context.shown(axis, context.zero_offsets.offsets_mm.get(place, 0.0))


def _write_group(
    context: Context, block: Block, rest: str, value: Value, group: int, *indices: int
) -> Iterator[canon.Command]:
    """V.G.NP[]: acts when the group is selected again. TF5200 206493195."""
    axis = context.indexed_axis(block, rest, list(indices))
    place = _group(context, block, group), context.axes.index(axis)
    context.zero_offsets.offsets_mm[place] = context.mm(axis, context.number(block, value))
    return iter(())


def _read_in_use(context: Context, block: Block, rest: str, *indices: int) -> float:
    axis = context.indexed_axis(block, rest, list(indices))
    return context.shown(axis, context.coordinates.shifts(axis).zero_mm)


def _write_in_use(
    context: Context, block: Block, rest: str, value: Value, *indices: int
) -> Iterator[canon.Command]:
    """V.G.NP_AKT: until a group is selected. TF5200 206505739."""
    axis = context.indexed_axis(block, rest, list(indices))
    context.coordinates.write_zero(axis, context.mm(axis, context.number(block, value)))
    return iter(())


def _origin(context: Context, block: Block, letter: str) -> float:
    """V.G.SELECTED_CS.TRANS: from the axes to the active system, by place. TF5200 1049034507."""
    return context.coordinates.origin_acs_mm["XYZ".index(letter)] / context.unit_mm


TOPIC = Topic(
    settings={
        **{g: _zero_offset(group) for g, group in ZERO_OFFSETS.items()},
        "G159": silent(_numbered_offset),
        **{g: _choose_plane(g) for g in PLANES},
        "G70": _choose_unit(True),
        "G71": _choose_unit(False),
    },
    takes_axes={"G92": silent(_reference_point)},
    read_addresses=("G159",),
    readers={
        "V.A.PROG": _of_axis(Coordinates.programmed_mm),
        "V.A.ABS": _of_axis(Coordinates.absolute_mm),
        "V.A.ACS.ABS": _of_axis(lambda coordinates, axis: coordinates.acs_mm[axis]),
        "V.A.ACT_POS": _actual,
        "V.A.BZP": _of_axis(lambda coordinates, axis: coordinates.shifts(axis).reference_mm),
        "V.G.MASS_MM": _unit,
        "V.G.NP_DEFAULT": _default_group,
        "V.G.NP[].V": _read_group,
        "V.G.NP[].V[]": _read_group,
        "V.G.NP_AKT.V": _read_in_use,
        "V.G.NP_AKT.V[]": _read_in_use,
        "V.G.SELECTED_CS.TRANS": _origin,
    },
    writers={
        "V.G.NP_DEFAULT": _choose_default,
        "V.G.NP[].V": _write_group,
        "V.G.NP[].V[]": _write_group,
        "V.G.NP_AKT.V": _write_in_use,
        "V.G.NP_AKT.V[]": _write_in_use,
    },
)
