"""A drive that only takes a speed, with images by hand: power, images that stay out, standstill."""

from dataclasses import replace

import pytest
from tests.speed_drive.ends import FAMILIES, SETTINGS
from tests.speed_drive.test_speed_drive_stop import COUNTS, KV_PER_S, OPERATES, Hand

from axisrig.kernel.drives.conventional.link import IMAGES as CARD_IMAGES
from axisrig.kernel.drives.conventional.link import ConventionalDrive
from axisrig.kernel.drives.cyclic.carrier import ImagePort
from axisrig.kernel.drives.power import Power, PowerOrder, PowerRequest
from axisrig.kernel.drives.speed_drive.watch import SpeedDriveWatch
from axisrig.kernel.errors import Alarm
from axisrig.kernel.profiles.encoder_terminal import words as terminal
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


# The way at a latch


def test_the_first_image_after_the_begin_has_no_way_before_it() -> None:
    """A counter that stands far from 0 has not moved there; afterwards each way counts."""
    moved: list[tuple[int, int]] = []

    class Noting(ConventionalDrive):
        def _take_latch(self, values: dict[str, int], place: int, travel: int) -> None:
            moved.append((place, travel))

    port = ImagePort()
    link = Noting(replace(SETTINGS, echo_cycles=1), port)
    for at in (5000, 5010, 4990):
        port.receive(CARD_IMAGES[1].packed({"DRIVE": OPERATES, "COUNTER": at}))
        link.take()
    assert moved == [(5000, 0), (5010, 10), (4990, -20)]


# A drive that is led from a place


def test_an_axis_whose_counter_is_lost_goes_on_with_an_alarm_and_is_not_led_again() -> None:
    """An encoder terminal: without a place no enable; in operation it goes on, and is an alarm."""
    hand = Hand("encoder_terminal")
    accepted = terminal.CNTSET_ACC

    def cycle(drive: int, status: int) -> int:
        hand.port.receive(hand.from_drive.packed({"DRIVE": drive, "STATUS": status}))
        hand.link.take()
        hand.link.send(0.0)
        assert hand.port.outputs is not None
        return hand.to_drive.values_of(hand.port.outputs)["DRIVE"]

    watch = SpeedDriveWatch(hand.link)
    sent = [cycle(READY, 0) for _ in range(3)]
    assert (sent, hand.link.is_placed) == ([0, 0, 0], False)
    assert [cycle(READY, accepted) for _ in range(2)] == [ENABLE, ENABLE]
    assert watch.communication() is None
    assert cycle(OPERATES, accepted) == ENABLE
    assert cycle(OPERATES, 0) == ENABLE
    for status in (0, accepted):  # it does not come back by itself
        cycle(OPERATES, status)
        found = watch.communication()
        assert found is not None
        assert (found.id, found.values) == (900781, {"axis": "Z"})
        assert cycle(READY, status) == 0


# The watch


def watched(family: str = "conventional", **settings: float) -> tuple[Hand, SpeedDriveWatch]:
    hand = Hand(family)
    link = FAMILIES[family].link(replace(SETTINGS, echo_cycles=1, **settings), hand.port, int)
    link.order(PowerOrder.SWITCH_ON)
    hand.link = link
    return hand, SpeedDriveWatch(link)


@pytest.mark.parametrize(
    ("drive", "alarm_id"), [(OPERATES, None), (READY, 900027), (0, 900027), (FAULT, 900005)]
)
def test_what_leaves_operation_is_an_alarm_unless_it_was_stopped(
    drive: int, alarm_id: int | None
) -> None:
    hand, watch = watched()
    hand.cycle(0.0, drive)
    found = watch.condition()
    assert (found and found.id) == alarm_id
    hand.link.order(PowerOrder.STOP)
    hand.cycle(0.0, drive)
    assert watch.condition() is None


def test_the_lag_of_a_drive_in_operation_is_watched() -> None:
    hand, watch = watched(lag_limit_mm=0.5)
    for set_mm, alarm_id in ((0.5, None), (0.51, 900036), (-0.51, 900036), (-0.5, None)):
        hand.cycle(set_mm)
        found = watch.condition()
        assert (found and found.id) == alarm_id
    hand.cycle(0.51, READY)
    found = watch.condition()
    assert found is not None
    assert found.id == 900027


def test_a_jump_of_the_counter_is_an_alarm_of_the_connection() -> None:
    hand, watch = watched(jump_mm=1.0)
    alarms = []
    for at in (0, 300, 1300, 1300):  # 409.6 increments are a mm
        hand.port.receive(hand.from_drive.packed({"DRIVE": OPERATES, "COUNTER": at}))
        hand.link.take()
        found = watch.communication()
        alarms.append(found and found.id)
    assert alarms == [None, None, 900029, None]
