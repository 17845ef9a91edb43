"""Tools: T names one, D takes its length, radius and axis offsets in."""

from dataclasses import dataclass

from kernel.nc.canon import Block
from kernel.nc.coordinates.tools import TOOLS
from kernel.nc.decoder.context import Context
from kernel.nc.decoder.topic import Topic, silent
from kernel.nc.syntax import Words


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


def _take(context: Context, block: Block, words: Words) -> None:
    """D: data of a tool; D0 takes them off. Source: TF5200 coordinate systems 306370955."""
    number = _number(context, block, words)
    tool = context.tools.find(number)
    if tool is None:
        raise context.alarm(900154, block, word=f"D{number}")
    context.part(ToolNumbers).d = number
    context.coordinates.tool = tool.copy()


def _number(context: Context, block: Block, words: Words) -> int:
    expression = words.address("D")
    assert expression is not None
    value = context.value(block, expression)
    number = round(value)
    if abs(value - number) > 1e-9 or not 0 <= number < TOOLS:
        raise context.alarm(900155, block, value=f"{value:g}", last=TOOLS - 1)
    return number


def _t(context: Context, block: Block, rest: str) -> float:
    return float(context.part(ToolNumbers).t)


def _d(context: Context, block: Block, rest: str) -> float:
    return float(context.part(ToolNumbers).d)


TOPIC = Topic(
    addresses={"T": silent(_announce), "D": silent(_take)},
    readers={"V.G.T_AKT": _t, "V.G.D_AKT": _d},
)
