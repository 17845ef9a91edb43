"""Tools: T names one, D takes its length, radius and axis offsets in."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

from axisrig.kernel.nc import canon
from axisrig.kernel.nc.block import Block
from axisrig.kernel.nc.coordinates import Tool
from axisrig.kernel.nc.coordinates.tools import TOOLS
from axisrig.kernel.nc.decoder.base.cells import whole_index
from axisrig.kernel.nc.decoder.base.context import Context
from axisrig.kernel.nc.decoder.base.topic import Reader, Topic, Writer, silent
from axisrig.kernel.nc.expressions import Value
from axisrig.kernel.nc.syntax import Words


@dataclass
class ToolNumbers:
    """The numbers of T and D; 0 without a tool."""

    t: int = 0
    d: int = 0


def _announce(context: Context, block: Block, words: Words) -> None:
    """T: the number of the tool; its data come with D (P-CHAN-00014 = 0)."""
    expression = words.address("T")
    assert expression is not None
    context.part(ToolNumbers).t = round(context.value(block, expression))


def _changed(context: Context, block: Block) -> Iterator[canon.Command]:
    """Warn of a tool that changes while a kinematic is on: it has taken its length."""
    kinematic = context.coordinates.kinematic
    if kinematic is not None:
        yield canon.Warn(block, context.alarm(900481, block, name=kinematic.name))


def _take(context: Context, block: Block, words: Words) -> Iterator[canon.Command]:
    """D: data of a tool; D0 takes them off. Source: TF5200 coordinate systems 306370955."""
    number = _number(context, block, words)
    tool = context.tools.find(number)
    if tool is None:
        raise context.alarm(900154, block, word=f"D{number}")
    context.part(ToolNumbers).d = number
    context.coordinates.tool = tool.copy()
    yield from _changed(context, block)


def _number(context: Context, block: Block, words: Words) -> int:
    expression = words.address("D")
    assert expression is not None
    value = context.value(block, expression)
    number = whole_index(value)
    if number is None or number >= TOOLS:
        raise context.alarm(900155, block, value=f"{value:.10g}", last=TOOLS - 1)
    return number


def _t(context: Context, block: Block, rest: str) -> float:
    return float(context.part(ToolNumbers).t)


def _d(context: Context, block: Block, rest: str) -> float:
    return float(context.part(ToolNumbers).d)


# Finds the data that a variable means: those in use, or those of a number
Find = Callable[[Context, Block, list[int]], Tool]


def _in_use(context: Context, block: Block, indices: list[int]) -> Tool:
    return context.coordinates.tool


def _of_number(context: Context, block: Block, indices: list[int]) -> Tool:
    number = indices.pop(0)
    if number >= TOOLS:
        raise context.index_alarm(block, "V.G.WZ[]", number, TOOLS - 1)
    return context.tools.record(number)


def _length(find: Find, name: str) -> tuple[Reader, Writer]:
    """Read and write length_mm or radius_mm of a tool."""

    def read(context: Context, block: Block, rest: str, *indices: int) -> float:
        value_mm: float = getattr(find(context, block, list(indices)), name)
        return value_mm / context.unit_mm

    def write(
        context: Context, block: Block, rest: str, value: Value, *indices: int
    ) -> Iterator[canon.Command]:
        setattr(
            find(context, block, list(indices)),
            name,
            context.number(block, value) * context.unit_mm,
        )
        if find is _in_use:
            yield from _changed(context, block)

    return read, write


def _offset(find: Find) -> tuple[Reader, Writer]:
    """Read and write the offset of an axis, by its name or by its index."""

    def read(context: Context, block: Block, rest: str, *indices: int) -> float:
        left = list(indices)
        tool = find(context, block, left)
        axis = context.indexed_axis(block, rest, left)
        return context.shown(axis, tool.offsets_mm.get(context.axes.index(axis), 0.0))

    def write(
        context: Context, block: Block, rest: str, value: Value, *indices: int
    ) -> Iterator[canon.Command]:
        left = list(indices)
        tool = find(context, block, left)
        axis = context.indexed_axis(block, rest, left)
        tool.offsets_mm[context.axes.index(axis)] = context.mm(axis, context.number(block, value))
        return iter(())

    return read, write


def _is_valid(context: Context, block: Block, rest: str, *indices: int) -> float:
    return float(_of_number(context, block, list(indices)).valid)


def _make_valid(
    context: Context, block: Block, rest: str, value: Value, *indices: int
) -> Iterator[canon.Command]:
    _of_number(context, block, list(indices)).valid = bool(context.number(block, value))
    return iter(())


# Read and write of every variable. TF5200 tool management 318262795
_ACCESS: Mapping[str, tuple[Reader, Writer]] = {
    "V.G.WZ_AKT.L": _length(_in_use, "length_mm"),
    "V.G.WZ_AKT.R": _length(_in_use, "radius_mm"),
    "V.G.WZ_AKT.V": _offset(_in_use),
    "V.G.WZ_AKT.V[]": _offset(_in_use),
    "V.G.WZ[].L": _length(_of_number, "length_mm"),
    "V.G.WZ[].R": _length(_of_number, "radius_mm"),
    "V.G.WZ[].V": _offset(_of_number),
    "V.G.WZ[].V[]": _offset(_of_number),
    "V.G.WZ[].OK": (_is_valid, _make_valid),
}

TOPIC = Topic(
    addresses={"T": silent(_announce), "D": _take},
    readers={
        "V.G.T_AKT": _t,
        "V.G.D_AKT": _d,
        **{name: read for name, (read, _) in _ACCESS.items()},
    },
    writers={name: write for name, (_, write) in _ACCESS.items()},
)
