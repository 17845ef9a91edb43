"""The queue of decoded commands by hand: what closes it, for how long, and what comes up when."""

from collections.abc import Iterator
from typing import Any

import pytest

from axisrig.kernel.channel.path.lookahead import DEPTH, Lookahead
from axisrig.kernel.errors import Alarm
from axisrig.kernel.nc import canon
from axisrig.kernel.nc.block import Block

BLOCK = Block(1, 10, "N10")


def dwell(number: int) -> canon.Dwell:
    return canon.Dwell(Block(number, 10 * number, ""), 1)


def queue(*commands: Any) -> tuple[Lookahead, list[Any]]:
    """Alarms among the commands come up when they are decoded; an end of the program follows."""
    decoded: list[Any] = []

    def decode() -> Iterator[Any]:
        for command in commands:
            decoded.append(command)
            if isinstance(command, Alarm):
                raise command
            yield command
        yield canon.EndOfProgram(BLOCK)

    return Lookahead(decode(), lambda _message: None), decoded


@pytest.mark.parametrize("for_cycle", [False, True])
def test_a_wait_closes_the_queue_until_it_is_taken_or_for_the_next_cycle(for_cycle: bool) -> None:
    wait = canon.Wait(BLOCK, for_cycle=for_cycle)
    found, decoded = queue(dwell(1), wait, dwell(2), wait, dwell(3))
    found.begin_cycle()
    found.refill()
    found.pop()
    found.refill()
    assert (decoded, found.head) == ([dwell(1), wait], wait)
    found.pop()
    found.refill()
    if for_cycle:
        assert (decoded, found.is_empty) == ([dwell(1), wait], True)
        found.begin_cycle()
        found.refill()
    assert decoded == [dwell(1), wait, dwell(2), wait]
    assert found.head == dwell(2)
    found.pop()
    found.pop()
    found.begin_cycle()
    found.refill()
    assert (found.head, len(decoded)) == (dwell(3), 5)


@pytest.mark.parametrize(
    "closing", [canon.EndOfProgram(BLOCK), canon.ProgramStop(BLOCK, optional=False)]
)
def test_an_end_and_a_stop_close_the_queue_until_they_are_taken(closing: Any) -> None:
    found, decoded = queue(closing, dwell(1))
    found.begin_cycle()
    found.refill()
    found.refill()
    assert decoded == [closing]
    found.pop()
    found.refill()  # in the same cycle
    assert found.head == dwell(1)


def test_no_more_is_decoded_ahead_than_the_queue_is_deep() -> None:
    found, decoded = queue(*map(dwell, range(DEPTH + 5)))
    found.begin_cycle()
    found.refill()
    assert len(decoded) == DEPTH
    found.pop()
    found.refill()
    assert len(decoded) == DEPTH + 1
    assert found.head == dwell(1)


def test_a_block_that_cannot_be_decoded_comes_up_after_those_before_it() -> None:
    wrong = Alarm(50059, axis="Y")
    found, decoded = queue(dwell(1), dwell(2), wrong, dwell(3))
    found.begin_cycle()
    found.refill()
    assert (found.failed, found.head) == (wrong, dwell(1))
    found.pop()
    found.refill()
    found.pop()
    with pytest.raises(Alarm) as raised:
        found.refill()
    assert raised.value is wrong
    assert decoded == [dwell(1), dwell(2), wrong]
