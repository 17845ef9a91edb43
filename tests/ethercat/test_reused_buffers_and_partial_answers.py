"""Values of requests that wait, and clocks that answer half of what they are asked."""

import struct
from typing import Any

import pytest
from tests.drives.test_clocks_set_up import TIME, TIMES, Line
from tests.ethercat.test_mailbox_by_hand import OTHER, REQUEST, RESPONSE, Asked, coe, expedited

from axisrig.kernel.drives.ethercat.frames import Answer
from axisrig.kernel.profiles.ethercat.layouts import MailboxType


@pytest.mark.parametrize("is_queued", [True, False])
def test_a_value_is_written_as_it_was_when_it_was_asked_for(is_queued: bool) -> None:
    """A caller may use its buffer again, also while the request waits for its turn."""
    asked = Asked()
    if not is_queued:
        asked.take(MailboxType.COE, coe(RESPONSE, expedited()))
    data = bytearray(b"\x08")
    asked.mailbox.write(OTHER, 0, data, lambda _: None)
    data[0] = 3
    if is_queued:
        asked.mailbox._taken(MailboxType.COE, coe(RESPONSE, expedited()))
    else:
        asked.mailbox.port.waits = True
        asked.mailbox._silent()  # the second attempt
    assert asked.written[-1][:7] == coe(REQUEST, struct.pack("<BHBB", 0x2F, OTHER, 0, 8))


class Half(Line):
    """A line with a slave that does not answer for one register."""

    def __init__(self, number: int, register: int) -> None:
        super().__init__([300, 500], [0, 0, 0])
        self.half = 1001 + number | register << 16

    def _answer(self, command: int, asked: Any) -> Answer:
        found = super()._answer(command, asked)
        return Answer(bytes(len(asked.data)), 0) if asked.address == self.half else found


@pytest.mark.parametrize("register", [TIMES, TIME])
@pytest.mark.parametrize("number", [0, 1, 2])
def test_a_slave_that_answers_half_of_the_questions_is_silent(number: int, register: int) -> None:
    """Its times would count as 0."""
    line = Half(number, register)
    assert line.set_up() == [1001 + number]
    assert line.written == {}
