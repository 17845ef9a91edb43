"""Messages to the operator (#MSG)."""

from collections.abc import Iterator

from kernel.nc import canon, message
from kernel.nc.canon import Block
from kernel.nc.decoder.context import Context
from kernel.nc.decoder.topic import Topic
from kernel.nc.syntax import MessageOut, Text


def _put_out(context: Context, block: Block, statement: MessageOut) -> Iterator[canon.Command]:
    if statement.synchronous:
        yield canon.Wait(block)
    values = [
        argument if isinstance(argument, Text) else context.value(block, argument)
        for argument in statement.arguments
    ]
    try:
        text = message.formatted(statement.pieces, values)
    except message.NotWhole as fault:
        raise context.alarm(900107, block, value=f"{fault.value:g}", format=fault.element) from None
    numbers = tuple(value for value in values if not isinstance(value, Text))
    yield canon.Message(block, text, statement.synchronous, numbers)


TOPIC = Topic(statements={MessageOut: _put_out})
