"""Messages to the operator and to others (#MSG), errors of the program (#ERROR)."""

from collections.abc import Container, Iterator

from axisrig.kernel.nc import canon, message
from axisrig.kernel.nc.block import Block
from axisrig.kernel.nc.decoder.base.context import Context
from axisrig.kernel.nc.decoder.base.topic import Topic
from axisrig.kernel.nc.expressions import Value, whole_number
from axisrig.kernel.nc.syntax import Command, Expression, Text

# Who can be named after #MSG; nobody: the diagnosis of the CNC.
# Source: TF5200 programming manual 507845131
RECEIVERS = ("", "ISG_DIAG_BED", "DIAG", "HMI", "PLC", "EVENT_LOGGER")

# Source: TF5200 error management 207457163; classes: programming manual 15557035659
USER_IDS = range(1001)  # 0 is that of an error without one
ALARM_OF_CLASS = {0: 900130, 2: 900131, 7: 900132}


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


def _error(context: Context, block: Block, command: Command) -> Iterator[canon.Command]:
    """Report an error of the program: a warning and on, or the end of the program.

    Without ID the number is 0, without RC the class is 2. Raises Alarm 900131 or 900132, and
    900133 for another number.
    """
    given = {
        keyword: context.any_value(block, value)
        for keyword, value in command.options
        if isinstance(value, Expression)
    }
    number = _whole(context, block, "ID", given.pop("ID", 0.0), USER_IDS, "1 to 1000")
    reaction = _whole(context, block, "RC", given.pop("RC", 2.0), ALARM_OF_CLASS, "0, 2 or 7")
    details = ", ".join(
        f"{keyword} {value if isinstance(value, str) else format(value, 'g')}"
        for keyword, value in given.items()
    )
    alarm = context.alarm(
        ALARM_OF_CLASS[reaction],
        block,
        number=number,
        details=details or "without values",
    )
    if alarm.ends_program:
        raise alarm
    yield canon.Warn(block, alarm)


def _whole(
    context: Context, block: Block, keyword: str, value: Value, known: Container[int], allowed: str
) -> int:
    number = None if isinstance(value, str) else whole_number(value)
    if number is None or number not in known:
        raise context.alarm(900133, block, keyword=keyword, value=value, allowed=allowed)
    return number


def _names() -> Iterator[str]:
    """Every spelling that does not ask for an acknowledgement."""
    for kind in ("MSG", "MSG INFO"):
        for mode in ("", " SYN"):
            for receiver in RECEIVERS:
                yield f"{kind}{mode} {receiver}".rstrip()


TOPIC = Topic(commands={**dict.fromkeys(_names(), _put_out), "ERROR": _error})
