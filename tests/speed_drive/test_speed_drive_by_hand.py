"""A drive that only takes a speed, with images by hand: power, images that stay out, standstill."""

from dataclasses import replace

import pytest
from tests.speed_drive.ends import FAMILIES, SETTINGS
from tests.speed_drive.test_speed_drive_stop import COUNTS, KV_PER_S, OPERATES, Hand

from axisrig.kernel.drives.cyclic.carrier import ImagePort
from axisrig.kernel.drives.power import Power, PowerOrder, PowerRequest
from axisrig.kernel.errors import Alarm
from axisrig.kernel.profiles.speed_drive import words

MISSING_MAX = SETTINGS.missing_cycles


class Silent(Hand):
    """Images may stay out."""

    def missed(self, set_mm: float, image: bytes = b"") -> tuple[int, int | None]:
        """One cycle without an image, or with one of another length; the speed and the alarm."""
        self.link.begin_cycle()
        self.port.receive(image)
        found = None
        try:
            self.link.take()
        except Alarm as alarm:
            found = alarm.id
        self.link.send(set_mm)
        assert self.port.outputs is not None
        return self.to_drive.values_of(self.port.outputs)["SPEED"], found


@pytest.mark.parametrize("family", FAMILIES)
def test_nothing_is_latched_before_anything_was(family: str) -> None:
    link = FAMILIES[family].link(replace(SETTINGS, echo_cycles=1), ImagePort(), lambda: 0)
    assert (link.latched_mm, link.latched_speed_mm, link.is_confirmed()) == (None, 0.0, False)
    assert (link.is_clear, link.is_armed, link.has_latched, link.is_probing) == (False,) * 4


@pytest.mark.parametrize("family", FAMILIES)
@pytest.mark.parametrize("image", [b"", b"\0" * 40])
def test_images_may_stay_out_so_often_in_a_row_and_the_set_positions_alone_count(
    family: str, image: bytes
) -> None:
    """An image of another length is none. 0.01 mm in a cycle of 1 ms are 10 mm/s."""
    hand = Silent(family)
    hand.cycle(0.0)
    hand.cycle(0.5)
    speed = round(10.0 * COUNTS)
    for _ in range(3):
        for missing in range(1, MISSING_MAX + 3):
            found = hand.missed(0.5 + 0.01 * missing, image)
            assert found == (speed, 900780 if missing > MISSING_MAX else None)
            assert hand.link.arrival.is_new is False
        _, sent = hand.cycle(0.5)
        assert sent == round(KV_PER_S * 0.5 * COUNTS)  # the actual position is known again
        assert hand.link.arrival.is_new is True


@pytest.mark.parametrize("family", FAMILIES)
def test_the_alarm_says_how_many_images_have_stayed_out(family: str) -> None:
    hand = Silent(family)
    hand.cycle(0.0)
    for missing in range(1, MISSING_MAX + 4):
        hand.link.begin_cycle()
        if missing <= MISSING_MAX:
            hand.link.take()
            continue
        with pytest.raises(Alarm) as caught:
            hand.link.take()
        assert caught.value.values == {"axis": "Z", "cycles": missing}


@pytest.mark.parametrize("family", FAMILIES)
def test_an_axis_that_stands_on_its_increment_gets_no_speed(family: str) -> None:
    """Less than half an increment of lag, at rest; not while the set position moves."""
    hand = Hand(family)
    tiny_mm = 0.4 / SETTINGS.increments_per_mm
    hand.cycle(0.0)
    for set_mm, speed_mm_s in (
        (0.0, 0.0), (tiny_mm, 0.0), (tiny_mm, 0.0), (5.0, 5.0 * KV_PER_S), (5.0, 5.0 * KV_PER_S),
        (tiny_mm, tiny_mm * KV_PER_S), (tiny_mm, 0.0),
    ):  # fmt: skip
        assert hand.cycle(set_mm)[1] == round(speed_mm_s * COUNTS)


ENABLE, RESET = words.ENABLE, words.RESET
READY, FAULT = words.READY, words.READY | words.FAULT
REQUESTS = {
    # request: DRIVE that is sent when the drive is ready, operates, has a fault
    PowerRequest.OFF: (0, 0, 0),
    PowerRequest.ON: (ENABLE, ENABLE, 0),
    PowerRequest.KEEP: (0, ENABLE, 0),
    PowerRequest.RELEASE: (0, 0, 0),
    PowerRequest.STOP: (0, ENABLE, 0),
}


@pytest.mark.parametrize("family", ["conventional", "lightbus"])
@pytest.mark.parametrize("request_", REQUESTS)
@pytest.mark.parametrize("acknowledges", [False, True])
def test_what_the_drive_gets_is_in_the_table_of_requests(
    family: str, request_: PowerRequest, acknowledges: bool
) -> None:
    """KEEP and STOP go on with what it does, and never lead it into operation; see `power.csv`."""
    for number, drive in enumerate((READY, OPERATES, FAULT)):
        hand = Hand(family)
        hand.link.request = request_
        hand.link.acknowledges_faults = acknowledges
        expected = REQUESTS[request_][number]
        if drive == FAULT and acknowledges:
            expected = RESET
        assert hand.cycle(0.0, drive)[0] == expected, drive


@pytest.mark.parametrize("family", FAMILIES)
def test_its_power_is_what_the_image_and_the_request_say(family: str) -> None:
    hand = Hand(family)
    for drive, order, power in (
        (0, None, Power.OFF), (READY, None, Power.OFF), (OPERATES, None, Power.OPERATING),
        (OPERATES, PowerOrder.STOP, Power.STOPPING), (READY, None, Power.OFF),
        (OPERATES | words.FAULT, None, Power.FAULT), (OPERATES, PowerOrder.LET_GO, Power.OPERATING),
    ):  # fmt: skip
        if order is not None:
            hand.link.order(order)
        hand.cycle(0.0, drive)
        assert hand.link.power is power
