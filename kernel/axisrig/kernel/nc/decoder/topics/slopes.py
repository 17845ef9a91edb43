"""The acceleration profile (#SLOPE) and the weights of its values (G130 to G134).

Sources: TF5200 programming manual 207190411, 206590731 and 206596619.
"""

from collections.abc import Iterator

from axisrig.kernel.nc import canon
from axisrig.kernel.nc.block import Block
from axisrig.kernel.nc.decoder.base.context import Context
from axisrig.kernel.nc.decoder.base.topic import Handler, Topic
from axisrig.kernel.nc.expressions import whole_number
from axisrig.kernel.nc.syntax import Command, Expression, Name, Words

PROFILES = ("STEP", "TRAPEZ", "SIN2")
NOT_ACTING = "HSC"
PERCENT = 100.0


def _choose(context: Context, block: Block, command: Command) -> Iterator[canon.Command]:
    """#SLOPE [TYPE=.. NO_OPT=..]: raises Alarm 21629, 900105, and 900100 for HSC."""
    name = command.option("TYPE")
    assert isinstance(name, Name), "the table of commands has checked it"
    profile = name.value.upper()
    if profile == NOT_ACTING:
        raise context.not_acting(block, "#SLOPE [TYPE=HSC]", "acceleration profile")
    if profile not in PROFILES:
        raise context.alarm(21629, block, type=name.value, known=" ".join(PROFILES))
    no_opt = command.option("NO_OPT")
    if isinstance(no_opt, Expression):
        value = context.value(block, no_opt)
        if whole_number(value) not in (0, 1):
            raise context.alarm(900105, block, reason=f"NO_OPT = {value:g} is neither 0 nor 1")
    yield canon.SlopeChoice(block, profile)


def _choose_default(context: Context, block: Block, command: Command) -> Iterator[canon.Command]:
    """#SLOPE DEFAULT: the profile of P-CHAN-00071."""
    yield canon.SlopeChoice(block, None)


def _of_axes(word: str, what: str) -> Handler:
    def weigh(context: Context, block: Block, words: Words) -> Iterator[canon.Command]:
        shares = {
            axis: _share(context, block, word, value)
            for axis, value in context.axis_factors(block, words)
        }
        yield canon.DynamicWeights(block, what, shares)

    return weigh


def _of_all(word: str, what: str) -> Handler:
    def weigh(context: Context, block: Block, words: Words) -> Iterator[canon.Command]:
        value = words.address(word)
        assert value is not None, "checked by the parser"
        share = _share(context, block, word, context.value(block, value))
        yield canon.DynamicWeights(block, what, dict.fromkeys(context.axes, share))

    return weigh


def _share(context: Context, block: Block, word: str, percent: float) -> float:
    if percent <= 0.0:
        raise context.alarm(900174, block, word=word, weight=f"{percent:g}")
    return percent / PERCENT


TOPIC = Topic(
    commands={"SLOPE": _choose, "SLOPE DEFAULT": _choose_default},
    settings={
        "G131": _of_all("G131", "acceleration"),
        "G133": _of_all("G133", "ramp_time"),
        "G134": _of_all("G134", "contour_time"),
    },
    takes_axes={
        "G130": _of_axes("G130", "acceleration"),
        "G132": _of_axes("G132", "ramp_time"),
    },
    read_addresses=("G131", "G133", "G134"),
)
