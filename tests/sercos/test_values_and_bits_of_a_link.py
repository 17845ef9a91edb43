"""Values of 0 and below it, and each step of a latch, at the control's end of a SERCOS drive."""

import pytest
from tests.sercos.test_drive_by_hand import BITS, ENABLE, ON, OPERATES, RUN, TOGGLE, Bench

from axisrig.kernel.drives.power import PowerOrder
from axisrig.kernel.drives.sercos.settings import real_time_bits
from axisrig.kernel.errors import Alarm
from axisrig.kernel.profiles.sercos.service import Element


def test_a_second_encoder_at_0_is_there_as_any_other_value() -> None:
    """S-0-0053, increments with their sign; without one in an AT the last one is kept."""
    bench = Bench(second=True)
    found = []
    for value in (5, 0, -(2**31), 0, 2**31 - 1):
        bench.cycle(OPERATES, 0, 1300, -1310, value)
        found.append((bench.drive.second_increments, bench.drive.second_age_cycles))
        bench.data.forget()
        bench.drive.take()
        found.append((bench.drive.second_increments, bench.drive.second_age_cycles))
    assert found == [
        (5, 0), (5, 1), (0, 0), (0, 1), (-(2**31), 0), (-(2**31), 1), (0, 0), (0, 1),
        (2**31 - 1, 0), (2**31 - 1, 1),
    ]  # fmt: skip


@pytest.mark.parametrize("place", [-4000, -1, 0, 1, 2**31 - 1])
def test_a_place_with_any_sign_is_proved_over_the_service_channel(place: int) -> None:
    """S-0-0051 is a signed number of four bytes, in the AT and in the channel."""
    bench = Bench(proves_places=True)
    bench.drive.order(PowerOrder.SWITCH_ON)
    bench.cycle(0x8000, place)
    bench.drive.find_place()
    bench.channel.answer(place.to_bytes(4, "little", signed=True))
    bench.drive.find_place()
    assert bench.drive.is_placed
    assert bench.cycle(0x8000, place) & ~TOGGLE == ON | ENABLE | RUN


@pytest.mark.parametrize("number", BITS)
def test_each_step_of_a_latch_is_shown_by_itself(number: int) -> None:
    """Clear, ordered, armed, latched, and off again; two cycles pass to the AT that shows it."""
    bench = Bench(bits=real_time_bits(number, 0), echo_cycles=2)
    _, done, _ = BITS[number]
    drive = bench.drive

    def shown(status: int) -> tuple[bool, bool, bool, bool]:
        bench.cycle(status, 7)
        return drive.is_clear, drive.is_probing, drive.is_armed, drive.has_latched

    assert [shown(OPERATES) for _ in range(2)] == 2 * [(True, False, False, False)]
    assert shown(OPERATES | done) == (False, False, False, False)  # a measurement of before
    assert shown(OPERATES) == (True, False, False, False)
    drive.arm()
    assert (drive.is_probing, drive.is_clear, drive.is_armed) == (True, False, False)
    assert shown(OPERATES) == (False, True, False, False)
    assert shown(OPERATES) == (False, True, True, False)
    assert shown(OPERATES | done) == (False, True, True, True)
    assert drive.latched_mm == 1.3
    drive.disarm()
    assert (drive.is_probing, drive.is_armed, drive.has_latched) == (False, False, False)
    assert shown(OPERATES | done) == (False, False, False, False)
    assert shown(OPERATES | done) == (False, False, False, False)
    assert shown(OPERATES) == (True, False, False, False)


@pytest.mark.parametrize(
    ("answer", "is_prepared"),
    [(b"\7\0", True), *((bytes((state, 0)), False) for state in (0, 3, 5, 0x0F))],
)
def test_a_measurement_waits_until_the_probing_cycle_is_known_to_run(
    answer: bytes, is_prepared: bool
) -> None:
    """The data state of S-0-0170 is asked for each time: 7 is in process, others are 900746."""
    bench = Bench(bits=real_time_bits(0, 0))
    for _ in range(2):
        bench.cycle(OPERATES)
        bench.drive.arm()
        assert bench.channel.asked == [(170, Element.DATA_STATE)]
        assert not bench.drive.is_prepared
        bench.channel.answer(answer)
        if is_prepared:
            assert bench.drive.is_prepared
        else:
            with pytest.raises(Alarm) as caught:
                assert bench.drive.is_prepared
            assert (caught.value.id, caught.value.values) == (900746, {"axis": "Z"})
        bench.drive.disarm()
        bench.channel.asked.clear()
