"""Variables of the decoder itself: own ones, the feed in force, PLC side."""

from axisrig.kernel.nc.block import Block
from axisrig.kernel.nc.decoder.base.context import Context
from axisrig.kernel.nc.decoder.base.topic import Topic
from axisrig.kernel.nc.decoder.variables import external, own


def _feed(context: Context, block: Block, rest: str) -> float:
    """V.G.FEEDRATE: the feed programmed last, in the unit of the program per minute; 0 without."""
    feed_mm_min = context.modal.feed_mm_min
    return 0.0 if feed_mm_min is None else feed_mm_min / context.unit_mm


TOPIC = Topic(
    statements=own.TOPIC.statements,
    commands=own.TOPIC.commands,
    readers={**own.TOPIC.readers, "V.G.FEEDRATE": _feed, "V.E": external.read},
    writers={**own.TOPIC.writers, "V.E": external.write},
)
