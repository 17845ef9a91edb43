"""Messages to the operator (#MSG)."""

from collections.abc import Iterator

from kernel.nc import canon, message
from kernel.nc.canon import Block
from kernel.nc.decoder.context import Context
from kernel.nc.decoder.topic import Topic
from kernel.nc.syntax import Command, Expression, Text


def _put_out(context: Context, block: Block, command: Command) -> Iterator[canon.Command]:
    synchronous = command.name == "MSG SYN"
    if synchronous:
        yield canon.Wait(block)
    first, *arguments = command.arguments
    assert isinstance(first, Text), "the text has been checked"
    values = [
        argument if isinstance(argument, Text) else context.value(block, argument)
        for argument in arguments
        if isinstance(argument, Expression)
    ]
    try:
        text = message.formatted(message.pieces_of(first.value), values)
    except message.NotWhole as fault:
        raise context.alarm(900107, block, value=f"{fault.value:g}", format=fault.element) from None
    numbers = tuple(value for value in values if not isinstance(value, Text))
    yield canon.Message(block, text, synchronous, numbers)


TOPIC = Topic(commands={"MSG": _put_out, "MSG SYN": _put_out})
