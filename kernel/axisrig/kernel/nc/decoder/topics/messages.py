"""Messages to the operator and to others (#MSG)."""

from collections.abc import Iterator

from axisrig.kernel.nc import canon, message
from axisrig.kernel.nc.canon import Block
from axisrig.kernel.nc.decoder.base.context import Context
from axisrig.kernel.nc.decoder.base.topic import Topic
from axisrig.kernel.nc.syntax import Command, Expression, Text

# Who can be named after #MSG; nobody: the diagnosis of the CNC.
# Source: TF5200 programming manual 507845131
RECEIVERS = ("", "ISG_DIAG_BED", "DIAG", "HMI", "PLC", "EVENT_LOGGER")


def _put_out(context: Context, block: Block, command: Command) -> Iterator[canon.Command]:
    words = command.name.split()[1:]
    synchronous = "SYN" in words
    if synchronous:
        yield canon.Wait(block)
    first, *arguments = command.arguments
    assert isinstance(first, Text), "the text has been checked"
    values = [
        context.any_value(block, argument)
        for argument in arguments
        if isinstance(argument, Expression)
    ]
    shown = [Text(value) if isinstance(value, str) else value for value in values]
    try:
        text = message.formatted(message.pieces_of(first.value), shown)
    except message.NotFitting as fault:
        raise context.alarm(900107, block, value=fault.shown, format=fault.element) from None
    numbers = tuple(value for value in values if not isinstance(value, str))
    receiver = " ".join(word for word in words if word != "SYN")
    yield canon.Message(block, text, synchronous, numbers, receiver)


def _names() -> Iterator[str]:
    """Every spelling that does not ask for an acknowledgement."""
    for kind in ("MSG", "MSG INFO"):
        for mode in ("", " SYN"):
            for receiver in RECEIVERS:
                yield f"{kind}{mode} {receiver}".rstrip()


TOPIC = Topic(commands=dict.fromkeys(_names(), _put_out))
