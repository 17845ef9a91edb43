"""The order in which blocks are decoded, and the end of the program."""

from kernel.nc.canon import Block
from kernel.nc.decoder.context import Context
from kernel.nc.decoder.topic import Topic, silent
from kernel.nc.syntax import Words


def _end(context: Context, block: Block, words: Words) -> None:
    context.ends = True


TOPIC = Topic(endings={"M2": silent(_end), "M30": silent(_end)})
