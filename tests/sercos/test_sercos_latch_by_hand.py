"""The latch of a SERCOS drive AT by AT: which done measurement is one of this run, and its proof.

Real-time bit 1 enables, real-time bit 2 shows the done measurement (P-AXIS-00060 = 0 with 00106 as
its default). Two ATs after an MDT the drive has made one with it.
"""

from typing import Any

import pytest
from tests.sercos.test_drive_by_hand import Channel

from axisrig.kernel.drives.sercos.latch import SercosLatch
from axisrig.kernel.drives.sercos.service_channel import SoeError
from axisrig.kernel.drives.sercos.settings import RealTimeBits, real_time_bits
from axisrig.kernel.profiles.sercos.service import Element, ident_number
from axisrig.kernel.profiles.sercos.words import PROBES

ENABLE, DONE = 0x40, 0x80
BITS = RealTimeBits(ENABLE, DONE, ENABLE)
ECHO = 2
PROBING = (ident_number("S-0-0170"), Element.DATA_STATE)
RUNNING, IDLE, FAILED = b"\x07\0", b"\0\0", b"\x0f\0"
IDENTS = PROBES[1, "NEG"]


class Probe:
    """A latch and the service channel of its drive."""

    def __init__(self, *, proves: bool = True) -> None:
        self.channel = Channel()
        channel: Any = self.channel
        self.latch = SercosLatch(BITS, 0, IDENTS, channel, ECHO, proves=proves)

    def take(self, *telegrams: int, value: int | None = 1300) -> None:
        """ATs with these status words; the axis stands."""
        for status in telegrams:
            self.latch.take(status, value, 0)

    def clear(self) -> None:
        self.take(*[0] * ECHO)
        assert self.latch.is_clear

    def armed(self) -> None:
        """A run whose drive has had the enable bit, and shows no done measurement."""
        self.clear()
        self.latch.arm()
        self.take(*[0] * ECHO)
        assert self.latch.is_armed

    def asked(self) -> list[tuple[int, Any]]:
        found = list(self.channel.asked)
        self.channel.asked.clear()
        return found


@pytest.fixture
def probe() -> Probe:
    return Probe()


def test_the_bits_of_before_are_those_that_two_manuals_print() -> None:
    assert real_time_bits(0, 0) == BITS


# Which done measurement


def test_an_edge_right_after_the_enable_bit_is_one_of_this_run_too(probe: Probe) -> None:
    """No AT has shown the bit low since: it was low before the enable bit went out."""
    for _ in range(2):
        probe.clear()
        probe.latch.arm()
        probe.take(*[DONE] * ECHO)
        assert probe.latch.has_latched
        assert probe.latch.increments == 1300
        probe.latch.disarm()
        probe.take(*[0] * ECHO)


def test_a_done_measurement_after_the_enable_bit_is_one_of_this_run(probe: Probe) -> None:
    probe.clear()
    assert (probe.latch.enable, probe.latch.is_ordered) == (0, False)
    probe.latch.arm()
    assert (probe.latch.enable, probe.latch.is_ordered) == (ENABLE, True)
    states = []
    for status in (0, 0, 0, DONE, DONE):
        probe.take(status)
        states.append((probe.latch.is_clear, probe.latch.is_armed, probe.latch.has_latched))
    assert states == [
        (False, False, False), (False, True, False), (False, True, False), (False, True, True),
        (False, True, True),
    ]  # fmt: skip
    assert probe.latch.increments == 1300


def test_the_level_of_the_probe_is_no_done_measurement(probe: Probe) -> None:
    """The actuated probe has the other bit of the status word."""
    probe.armed()
    probe.take(*[ENABLE] * 3)
    assert (probe.latch.has_latched, probe.latch.increments) == (False, None)


def test_a_latch_is_clear_only_as_long_after_the_enable_bit_as_the_drive_answers(
    probe: Probe,
) -> None:
    probe.armed()
    probe.take(DONE)
    probe.latch.disarm()
    assert (probe.latch.enable, probe.latch.is_ordered, probe.latch.is_armed) == (0, False, False)
    is_clear = []
    for status in (0, DONE, DONE, 0, 0):  # the first one was made before the bit fell
        probe.take(status)
        is_clear.append(probe.latch.is_clear)
    assert is_clear == [False, False, False, True, True]


@pytest.mark.parametrize(
    "before",
    [
        (DONE,),  # it still shows the measurement of the run before
        (0, 0, DONE),  # it was clear, and has one that nobody has ordered
        (0,),  # what was made before the enable bit fell
        (),
    ],
)
def test_a_done_measurement_without_a_clear_one_before_it_is_none_of_this_run(
    probe: Probe, before: tuple[int, ...]
) -> None:
    probe.armed()
    probe.latch.disarm()
    probe.take(*before)
    probe.latch.arm()
    probe.take(*[DONE] * 5)
    assert probe.latch.is_armed
    assert (probe.latch.has_latched, probe.latch.increments) == (False, None)
    probe.take(0)  # clear while it is enabled: what comes now is of this run
    probe.take(DONE)
    assert probe.latch.has_latched


def test_arming_and_disarming_twice_is_once(probe: Probe) -> None:
    probe.armed()
    probe.latch.arm()
    assert probe.latch.is_armed  # the enable bit has not changed
    probe.latch.disarm()
    probe.take(0)
    probe.latch.disarm()
    probe.take(0)
    assert probe.latch.is_clear


# The value


@pytest.mark.parametrize("sign", [1, -1])
def test_the_value_is_that_of_the_first_at_with_the_bit_and_its_way_that_of_the_cycle(
    probe: Probe, sign: int
) -> None:
    probe.armed()
    for status, value, actual in (
        (0, 1, 1000), (DONE, None, 1010), (DONE, 1040, 1050), (DONE, 1041, 1060),
    ):  # fmt: skip
        probe.latch.take(status, None if value is None else sign * value, sign * actual)
    assert (probe.latch.increments, probe.latch.speed_increments) == (sign * 1040, sign * 40)


def test_a_way_from_0_is_one(probe: Probe) -> None:
    """Position 0 has come in a telegram as any other."""
    probe.armed()
    for status, actual in ((0, 40), (0, 0), (DONE, 25)):
        probe.latch.take(status, 20, actual)
    assert (probe.latch.increments, probe.latch.speed_increments) == (20, 25)


def test_the_first_telegram_of_an_axis_has_no_way() -> None:
    probe = Probe()
    probe.latch.take(0, 5, 90_000)
    probe.latch.take(0, 5, 90_000)
    probe.latch.arm()
    probe.take(0, 0)
    probe.latch.take(DONE, 5, 0)
    assert probe.latch.speed_increments == 0


def test_a_new_run_has_nothing_of_the_one_before(probe: Probe) -> None:
    for value in (1300, 1400):
        probe.armed()
        assert probe.latch.increments is None
        probe.take(DONE, value=value)
        assert probe.latch.increments == value
        probe.latch.disarm()


# The probing cycle


@pytest.mark.parametrize(
    ("answer", "is_prepared", "is_refused"),
    [(RUNNING, True, False), (IDLE, False, True), (FAILED, False, True), (None, False, True)],
)
def test_a_run_is_prepared_where_the_probing_cycle_runs(
    probe: Probe, answer: bytes | None, is_prepared: bool, is_refused: bool
) -> None:
    for _ in range(2):
        probe.latch.arm()
        assert probe.asked() == [PROBING]
        assert (probe.latch.is_prepared, probe.latch.is_refused) == (False, False)
        probe.channel.refuse() if answer is None else probe.channel.answer(answer)
        assert (probe.latch.is_prepared, probe.latch.is_refused) == (is_prepared, is_refused)
        probe.latch.disarm()


def test_an_answer_to_an_earlier_run_prepares_nothing(probe: Probe) -> None:
    probe.latch.arm()
    probe.latch.arm()
    probe.channel.answer(RUNNING)
    assert not probe.latch.is_prepared
    probe.channel.answer(IDLE)
    assert probe.latch.is_refused


# The proof


def latched(probe: Probe, value: int) -> None:
    probe.armed()
    probe.channel.answer(RUNNING)
    assert not probe.latch.is_confirmed()
    probe.take(DONE, value=value)
    probe.channel.asked.clear()


@pytest.mark.parametrize("value", [1300, -1300])
def test_a_value_is_confirmed_by_done_measurement_and_value_of_the_channel(
    probe: Probe, value: int
) -> None:
    latched(probe, value)
    for _ in range(3):
        assert not probe.latch.is_confirmed()
    assert probe.asked() == [(IDENTS.latched, Element.VALUE)]
    probe.channel.answer(b"\x01\0")
    assert not probe.latch.is_confirmed()
    assert probe.asked() == [(IDENTS.value, Element.VALUE)]
    probe.channel.answer((value & 0xFFFFFFFF).to_bytes(4, "little"))
    assert probe.latch.is_confirmed()
    assert probe.asked() == []


@pytest.mark.parametrize("done", [b"\0\0", b"\x02\0", None])
def test_without_a_done_measurement_there_no_value_is_asked_for(
    probe: Probe, done: bytes | None
) -> None:
    """It is bit 0 of S-0-0409 and following."""
    latched(probe, 1300)
    assert not probe.latch.is_confirmed()
    probe.channel.refuse() if done is None else probe.channel.answer(done)
    assert not probe.latch.is_confirmed()
    assert probe.asked() == [(IDENTS.latched, Element.VALUE)]


@pytest.mark.parametrize("other", [1301, None])
def test_another_value_confirms_nothing_and_the_next_run_asks_anew(
    probe: Probe, other: int | None
) -> None:
    latched(probe, 1300)
    assert not probe.latch.is_confirmed()
    probe.channel.answer(b"\x01\0")
    if other is None:
        probe.channel.refuse()
    else:
        probe.channel.answer(other.to_bytes(4, "little"))
    assert not probe.latch.is_confirmed()
    probe.latch.disarm()
    latched(probe, 1400)
    assert not probe.latch.is_confirmed()
    probe.channel.answer(b"\x01\0")
    probe.channel.answer((1400).to_bytes(4, "little"))
    assert probe.latch.is_confirmed()


def test_an_answer_to_the_run_before_confirms_nothing(probe: Probe) -> None:
    latched(probe, 1300)
    assert not probe.latch.is_confirmed()
    probe.latch.disarm()
    probe.armed()
    probe.take(DONE)
    probe.channel.asked.clear()
    probe.channel.answer(b"\x01\0")  # of the run before
    assert probe.asked() == []
    probe.channel.answer(RUNNING)
    assert not probe.latch.is_confirmed()


def test_without_a_proof_the_value_of_the_at_is_enough() -> None:
    probe = Probe(proves=False)
    probe.armed()
    assert not probe.latch.is_confirmed()
    probe.take(DONE)
    probe.channel.asked.clear()
    assert probe.latch.is_confirmed()
    assert probe.asked() == []


def test_an_error_of_the_channel_names_its_ident() -> None:
    assert str(SoeError(ident_number("S-0-0170"), None)) == "S-0-0170: no answer"
