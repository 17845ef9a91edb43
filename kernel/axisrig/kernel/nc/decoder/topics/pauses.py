"""Where a program waits: dwell time, exact stop, programmed stop, emptying the channel."""

from collections.abc import Iterator
from dataclasses import dataclass

from axisrig.kernel.nc import canon
from axisrig.kernel.nc.block import Block
from axisrig.kernel.nc.decoder.base.context import Context
from axisrig.kernel.nc.decoder.base.topic import Topic, silent
from axisrig.kernel.nc.decoder.base.waiting import Waiting
from axisrig.kernel.nc.decoder.base.walk import read_by
from axisrig.kernel.nc.syntax import Command, Expression, Group, Name, Words

# Dwell times are kept in us of 32 bits (TF5200 diagnosis 252425611, 252429963)
DWELL_MAX_US = 2**32 - 1
NS_PER_US = 1000
US_PER_S = 1_000_000
# The address of a time that follows G4 without one
DWELL_ADDRESS = "G4"
CENTRE = "IJK"  # a full circle needs no axis word


@dataclass
class BlockEnds:
    """How blocks of motion end.

    exact_stop: G360 is on. contouring: G261 is on. rounds: G61 was in the last block of motion.
    """

    exact_stop: bool = False
    contouring: bool = False
    rounds: bool = False


def _dwell(context: Context, block: Block, words: Words) -> Iterator[canon.Command]:
    """G4: seconds after it, or after the name of the first main axis.

    Source: TF5200 programming manual 206132747, diagnosis 250532491, 252216715.
    """
    values = dict(words.axes)
    time = values.pop(context.axes[0], None)
    direct = words.address(DWELL_ADDRESS)
    if time is not None and direct is not None:
        raise context.alarm(20013, block)
    time = direct if time is None else time
    if time is None:
        raise context.alarm(900171, block, word="G4")
    for axis in values:
        yield canon.Warn(block, context.alarm(20685, block, axis=axis))
    yield _waiting(context, block, context.value(block, time), 20752)


def _time(context: Context, block: Block, command: Command) -> Iterator[canon.Command]:
    """#TIME in seconds. Source: TF5200 programming manual 206132747."""
    (time,) = command.arguments
    assert isinstance(time, Expression)
    yield _waiting(context, block, context.value(block, time), 20751)


def _waiting(context: Context, block: Block, time_s: float, alarm_id: int) -> canon.Dwell:
    duration_us = time_s * US_PER_S
    is_near = 0.0 <= duration_us < DWELL_MAX_US + 1.0
    # The longest time in s is no exact float: whole ns count
    duration_ns = round(duration_us * NS_PER_US) if is_near else 0
    if not is_near or duration_ns > DWELL_MAX_US * NS_PER_US:
        raise context.alarm(
            alarm_id, block, value=f"{duration_us:.15g}", lower=0, upper=DWELL_MAX_US
        )
    return canon.Dwell(block, duration_ns)


def _stop(context: Context, block: Block, words: Words) -> Iterator[canon.Command]:
    yield canon.ProgramStop(block, optional="M0" not in words.m)


def _flush(context: Context, block: Block, command: Command) -> None:
    """Nothing is held back here: every block ends at standstill and begins as soon as it can."""


def _flush_wait(context: Context, block: Block, command: Command) -> Iterator[canon.Command]:
    """Decode on when everything before has been interpolated. TF5200 programming 207042443."""
    yield canon.Wait(block)


def _wait_for(context: Context, block: Block, command: Command) -> Iterator[canon.Command]:
    """Decode on when the condition holds (above 0.5), asked in every cycle.

    Raises Alarm 900173 when nothing in it can change meanwhile, 900126 when the PLC side does not.
    Source: TF5200 programming manual 207058059.
    """
    (condition,) = command.arguments
    assert not isinstance(condition, Name | Group | None)
    while context.value(block, condition) <= 0.5:
        if not any(variable.name.startswith("V.E.") for variable in read_by(command)):
            raise context.alarm(900173, block)
        waiting = context.part(Waiting)
        if waiting.is_constant:
            raise waiting.alarm(context, block, block)
        yield canon.Wait(block, for_cycle=True)


def _exact_stop_on(context: Context, block: Block, words: Words) -> None:
    context.part(BlockEnds).exact_stop = True


def _exact_stop_off(context: Context, block: Block, words: Words) -> None:
    context.part(BlockEnds).exact_stop = False


def _contouring_on(context: Context, block: Block, words: Words | Command) -> None:
    context.part(BlockEnds).contouring = True


def _contouring_off(context: Context, block: Block, words: Words | Command) -> None:
    ends = context.part(BlockEnds)
    ends.contouring = ends.rounds = False


def _nothing(context: Context, block: Block, words: Words | Command) -> None:
    """Every block begins and ends at standstill, whatever is asked of its ends."""


def block_end(context: Context, block: Block, words: Words) -> Iterator[canon.Command]:
    """Decode how a block that moves axes ends; called after its move.

    Source: TF5200 programming manual 206301707 (G60, G359, G360).
    """
    ends = context.part(BlockEnds)
    if words.axes or any(letter in CENTRE for letter, _ in words.addresses):
        ends.rounds = "G61" in words.g
        if ends.exact_stop or "G60" in words.g:
            yield canon.ExactStop(block)
    elif "G60" in words.g:
        yield canon.Warn(block, context.alarm(20003, block, g_function="G60"))


def require_no_contouring(context: Context, block: Block, words: Words) -> None:
    """Refuse a measuring run while polynomial contouring is on.

    Raises Alarm 120652. Source: FCT-C4 section 2, TF5200 diagnosis 265303179.
    """
    ends = context.part(BlockEnds)
    if ends.contouring or ends.rounds or "G61" in words.g:
        raise context.alarm(120652, block)


TOPIC = Topic(
    read_addresses=(DWELL_ADDRESS,),
    takes_axes={"G4": _dwell},
    settings={
        "G8": silent(_nothing),
        "G9": silent(_nothing),
        "G60": silent(_nothing),
        "G61": silent(_nothing),
        "G260": silent(_contouring_off),
        "G261": silent(_contouring_on),
        "G359": silent(_exact_stop_off),
        "G360": silent(_exact_stop_on),
        "G900": silent(_nothing),
        "G901": silent(_nothing),
    },
    endings={"M0": _stop, "M1": _stop},
    commands={
        "TIME": _time,
        "FLUSH": silent(_flush),
        "FLUSH CONTINUE": silent(_flush),
        "FLUSH WAIT": _flush_wait,
        "WAIT FOR": _wait_for,
        "CONTOUR MODE": silent(_nothing),
        "CONTOUR MODE ON": silent(_contouring_on),
        "CONTOUR MODE OFF": silent(_contouring_off),
    },
)
