"""Moves of the axes in a common path, and the words that shape them."""

from collections.abc import Iterator, Mapping

from axisrig.kernel.nc import canon
from axisrig.kernel.nc.block import Block
from axisrig.kernel.nc.decoder.base.context import Context
from axisrig.kernel.nc.decoder.base.topic import Topic, silent
from axisrig.kernel.nc.decoder.topics import circles, pauses
from axisrig.kernel.nc.syntax import Words


def _rapid(context: Context, block: Block, words: Words) -> None:
    context.modal.motion = "G0"


def _straight(context: Context, block: Block, words: Words) -> None:
    context.modal.motion = "G1"


def _absolute(context: Context, block: Block, words: Words) -> None:
    context.modal.absolute = True


def _relative(context: Context, block: Block, words: Words) -> None:
    context.modal.absolute = False


def _feed(context: Context, block: Block, words: Words) -> None:
    assert words.feed is not None
    context.modal.feed_mm_min = context.value(block, words.feed) * context.unit_mm


def _feed_per_minute(context: Context, block: Block, words: Words) -> None:
    """G94 is what F means here: mm/min."""


def _nothing(context: Context, block: Block, words: Words) -> None:
    """G40: no tool radius compensation is ever on."""


def move(context: Context, block: Block, words: Words) -> Iterator[canon.Command]:
    """Decode axis words that no other function of the block takes."""
    if context.modal.motion in circles.ARCS:
        yield from circles.arc(context, block, words)
    else:
        circles.refuse_centre(context, block, words, context.modal.motion)
        values = context.axis_values(block, words)
        if values:
            yield from _go(context, block, values)
    yield from pauses.block_end(context, block, words)


def _go(context: Context, block: Block, values: Mapping[str, float]) -> Iterator[canon.Command]:
    rapid = context.modal.motion == "G0"
    feed_mm_min = None if rapid else context.feed(block, "G1")
    coordinates = context.coordinates
    begin_mm = coordinates.base_mm
    target_mm = coordinates.aim(values, absolute=context.modal.absolute)
    for stop_mm in coordinates.stops_mm(begin_mm) if target_mm else ():
        yield canon.LinearMove(block, stop_mm, rapid, feed_mm_min)
    if target_mm:
        yield canon.LinearMove(block, target_mm, rapid, feed_mm_min)


TOPIC = Topic(
    addresses={"F": silent(_feed)},
    settings={
        "G0": silent(_rapid),
        "G1": silent(_straight),
        "G40": silent(_nothing),
        "G90": silent(_absolute),
        "G91": silent(_relative),
        "G94": silent(_feed_per_minute),
    },
)
