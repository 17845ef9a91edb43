"""What a drive may be led from: a place that SDO has proved, and what voids the proof."""

from collections.abc import Callable
from typing import Any

import pytest
from tests.drives.test_link_by_hand import OPERATION_ENABLED, Wire
from tests.drives.test_position_check import FakeSdo

from axisrig.kernel.drives.canopen.link import AxisLink
from axisrig.kernel.drives.canopen.link_settings import LinkSettings
from axisrig.kernel.drives.position_watch import jump_alarm
from axisrig.kernel.drives.power import PowerOrder

SWITCHED_ON, READY, FAULT, QUICK_STOP = 0x1233, 0x1231, 0x0218, 0x1217
HOLD_SWITCHED_ON, HOLD_QUICK_STOP, HOLD_OPERATION = 0x07, 0x02, 0x0F
"""Controlwords of CiA 402 that stay in SWITCHED ON and QUICK STOP ACTIVE, and lead to operation."""


class Bench:
    """A link whose place SDO proves; jumps are more than 1 mm in a cycle."""

    def __init__(self) -> None:
        self.wire, self.sdo = Wire(), FakeSdo()
        settings = LinkSettings("Z", 1000.0, node_id=3, jump_mm=1.0)
        sdo: Any = self.sdo
        self.link = AxisLink(settings, self.wire, sdo, proves_places=True)
        self.link.begin()

    def cycle(self, word: int, increments: int) -> int:
        """A telegram, the word that goes back, and the watch that takes note of jumps."""
        self.wire.status(word, increments)
        self.wire.latch()
        self.link.take()
        self.link.find_place()
        self.link.send(self.link.place_mm)
        jump_alarm(self.link)
        return self.wire.sent[0x203][0]

    def prove(self, word: int, increments: int) -> None:
        self.sdo.value = increments
        for _ in range(3):
            self.cycle(word, increments)
            self.sdo.answer()
        assert self.link.is_placed


@pytest.fixture
def bench() -> Bench:
    return Bench()


@pytest.mark.parametrize(
    ("word", "holds", "goes_on"),
    [(SWITCHED_ON, HOLD_SWITCHED_ON, HOLD_OPERATION), (QUICK_STOP, HOLD_QUICK_STOP, 0x00)],
)
def test_no_drive_goes_into_operation_before_its_place_is_proved(
    bench: Bench, word: int, holds: int, goes_on: int
) -> None:
    """Transition 4 of CiA 402 leads there; out of a quick stop it goes over 12, without power."""
    bench.link.order(PowerOrder.SWITCH_ON)
    bench.sdo.value = 4000
    for _ in range(5):
        assert bench.cycle(word, 4000) == holds
    bench.sdo.answer()
    assert bench.cycle(word, 4000) == goes_on


def test_before_it_is_switched_on_a_drive_is_led_on_without_a_proof(bench: Bench) -> None:
    """READY TO SWITCH ON (shutdown 06, switch on 07) and what comes before have no power."""
    bench.link.order(PowerOrder.SWITCH_ON)
    assert bench.cycle(0x1250, 4000) == 0x06
    assert bench.cycle(READY, 4000) == 0x07
    assert not bench.link.is_placed


def test_after_a_jump_the_place_of_before_counts_until_the_new_one_is_proved(bench: Bench) -> None:
    """4 mm, then 9 mm at once, then 7 mm: the axis is held at 4 mm until SDO reports 7 mm too."""
    link = bench.link
    bench.prove(READY, 4000)
    for place in (9000, 9001, 7000, 7000):
        bench.cycle(READY, place)
        assert (link.is_placed, link.place_mm) == (False, 4.0)
    bench.prove(READY, 7000)
    assert link.place_mm == 7.0
    bench.cycle(READY, 7001)
    assert link.place_mm == 7.001


def test_a_jump_before_anything_was_proved_has_no_place_of_before(bench: Bench) -> None:
    bench.cycle(READY, 4000)
    bench.cycle(READY, 9000)
    assert (bench.link.is_placed, bench.link.place_mm) == (False, 9.0)


def test_an_answer_about_the_place_of_before_does_not_prove_the_new_one(bench: Bench) -> None:
    bench.prove(READY, 4000)
    bench.cycle(READY, 9000)
    bench.cycle(READY, 4000)  # it jumps back, and is asked about anew
    bench.sdo.value = 4000
    bench.cycle(READY, 4000)
    assert not bench.link.is_placed
    bench.sdo.answer()
    bench.cycle(READY, 4000)
    assert (bench.link.is_placed, bench.link.place_mm) == (True, 4.0)


def test_a_jump_in_operation_voids_nothing(bench: Bench) -> None:
    """It is an alarm there (900029), and the drive goes on to follow its set positions."""
    bench.prove(SWITCHED_ON, 4000)
    bench.cycle(OPERATION_ENABLED, 4000)
    bench.cycle(OPERATION_ENABLED, 9000)
    assert (bench.link.is_placed, bench.link.place_mm) == (True, 9.0)


@pytest.mark.parametrize("word", [SWITCHED_ON, READY, FAULT])
def test_a_drive_that_leaves_operation_may_stand_elsewhere(bench: Bench, word: int) -> None:
    bench.prove(SWITCHED_ON, 4000)
    bench.cycle(OPERATION_ENABLED, 4000)
    assert bench.link.is_placed
    bench.cycle(word, 4000)
    assert not bench.link.is_placed
    bench.prove(word, 4000)
    bench.cycle(READY, 4000)  # another state without power: it still stands there
    bench.cycle(SWITCHED_ON, 4000)
    assert bench.link.is_placed


@pytest.mark.parametrize(
    "forgets", [AxisLink.forget_place, AxisLink.forget], ids=["homed", "restarted"]
)
def test_what_was_before_a_new_reference_is_no_place(
    bench: Bench, forgets: Callable[[AxisLink], None]
) -> None:
    """Not even that of before a jump."""
    bench.prove(READY, 4000)
    bench.cycle(READY, 9000)
    forgets(bench.link)
    assert (bench.link.is_placed, bench.link.place_mm) == (False, 9.0)


def test_without_a_telegram_nothing_is_asked(bench: Bench) -> None:
    bench.link.find_place()
    assert bench.sdo.asked == []
    bench.cycle(READY, 4000)
    bench.wire.latch()
    bench.link.take()
    bench.sdo.value = 4000
    bench.sdo.answer()
    bench.link.find_place()
    assert not bench.link.is_placed  # the telegram after the answer has stayed out
    bench.cycle(READY, 4000)
    assert bench.link.is_placed
    assert bench.sdo.asked == [(0x6064, 0)]
