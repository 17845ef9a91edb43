"""Machining coordinate systems (#CS)."""

from kernel.nc.canon import Block
from kernel.nc.coordinates import Frame
from kernel.nc.decoder.context import Context
from kernel.nc.decoder.topic import Topic, silent
from kernel.nc.syntax import SystemOff, SystemOn


def _on(context: Context, block: Block, statement: SystemOn) -> None:
    values = [context.value(block, component) for component in statement.components]
    context.coordinates.switch_on(Frame.of(values))


def _off(context: Context, block: Block, statement: SystemOff) -> None:
    if statement.all_systems:
        context.coordinates.switch_off_all()
    elif context.coordinates.transformed:
        context.coordinates.switch_off()
    else:
        raise context.alarm(900108, block)


TOPIC = Topic(statements={SystemOn: silent(_on), SystemOff: silent(_off)})
