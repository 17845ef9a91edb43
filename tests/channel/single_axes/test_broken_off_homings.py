"""Several axes leave a homing that was broken off: each in its time, all before the next program.

Also the limits of the homing of one axis: its time, its readings, and breaking off what is over.
"""

from itertools import permutations

import pytest
from tests.channel.single_axes.test_axis_homing import (
    AT_REST,
    ATTAINED,
    CSP,
    HOMING,
    Drive,
    NotingDrive,
    SlowDrive,
    cycles,
    homing,
)
from tests.channel.single_axes.test_homing_by_hand import BLOCK, Homed

from axisrig.kernel.channel.path.settling import REST_CYCLES
from axisrig.kernel.drives.cia402.homing import BLIND_CYCLES, MODE_POLLS_MAX, SDO_CYCLES, Phase
from axisrig.kernel.errors import Alarm
from axisrig.kernel.nc import canon
from axisrig.kernel.time.clock import MS, S

# Until both axes rest and the first step of their way back is done
TO_FIRST_STEP = REST_CYCLES + 1


def broken_off(groups: tuple[tuple[str, ...], ...] = (("X", "Y"),)) -> Homed:
    bench = Homed()
    bench.program.say(canon.Homing(BLOCK, groups))
    bench.turn(3)
    bench.single.stop()
    bench.put.clear()
    for home in bench.homes.values():
        home.steps = 0
    return bench


def test_both_axes_are_where_they_stand_until_both_are_led_back() -> None:
    bench = broken_off()
    bench.lead_back(2)
    assert bench.put == [("X", 0.5), ("Y", 5.5)] * 2
    bench.links["X"].place_mm, bench.links["Y"].place_mm = 0.25, 5.75
    bench.lead_back()
    assert bench.put[-2:] == [("X", 0.25), ("Y", 5.75)]


@pytest.mark.parametrize("moving", ["X", "Y"])
def test_no_axis_leaves_while_one_of_them_still_moves(moving: str) -> None:
    bench = broken_off()
    for _ in range(2 * REST_CYCLES):
        bench.links[moving].actual_increments += 3  # two would be the flicker of an encoder
        assert bench.lead_back() == [False]
    assert [home.steps for home in bench.homes.values()] == [0, 0]
    assert bench.lead_back(REST_CYCLES) == [False] * REST_CYCLES  # since it moved last
    assert [home.steps for home in bench.homes.values()] == [1, 1]


@pytest.mark.parametrize("first", ["X", "Y"])
def test_the_way_back_is_over_when_the_last_axis_is_there(first: str) -> None:
    """The one that is there gets no further step, and its set position is let alone."""
    last = {"X": "Y", "Y": "X"}[first]
    bench = broken_off()
    bench.lead_back(TO_FIRST_STEP + 3)
    assert [home.steps for home in bench.homes.values()] == [4, 4]
    bench.homes[first].is_done = True
    assert bench.lead_back(5) == [False] * 5
    assert (bench.homes[first].steps, bench.homes[last].steps) == (5, 9)
    assert {axis for axis, _ in bench.put[-4:]} == {last}
    bench.homes[last].is_done = True
    assert bench.lead_back() == [True]
    bench.put.clear()
    assert bench.lead_back(3) == [True] * 3
    assert (bench.put, bench.homes[last].steps) == ([], 10)


def test_of_groups_one_after_the_other_the_present_one_is_led_back() -> None:
    bench = broken_off((("Y",), ("X",)))
    assert list(bench.homes) == ["Y"]
    bench.homes["Y"].is_done = True
    assert bench.lead_back(TO_FIRST_STEP)[-1] is True
    assert {axis for axis, _ in bench.put} == {"Y"}


def test_a_homing_of_another_axis_joins_those_that_still_leave() -> None:
    """X is not back yet when the homing of Y is broken off too: both are waited for."""
    bench = broken_off((("X",),))
    bench.lead_back(2)
    bench.program.say(canon.Homing(BLOCK, (("Y",),)))
    bench.turn(2)
    bench.single.stop()
    bench.put.clear()
    assert bench.lead_back() == [False]
    assert bench.put == [("X", 0.5), ("Y", 5.5)]
    bench.lead_back(REST_CYCLES)
    bench.homes["Y"].is_done = True
    assert bench.lead_back() == [False]
    bench.homes["X"].is_done = True
    assert bench.lead_back() == [True]


@pytest.mark.parametrize("groups", [(("Y", "X"),), (("X", "Y"),), (("X",), ("Y",))])
def test_what_was_prepared_for_an_axis_that_homes_counts_no_more(
    groups: tuple[tuple[str, ...], ...],
) -> None:
    bench = Homed()
    bench.program.say(canon.Homing(BLOCK, groups))
    assert bench.forgotten == [axis for group in groups for axis in group]


@pytest.mark.parametrize("axes", list(permutations("XY")))
def test_axes_of_a_group_are_homed_in_one_cycle(axes: tuple[str, ...]) -> None:
    bench = Homed()
    bench.program.say(canon.Homing(BLOCK, (axes,)))
    bench.turn(2)
    for axis in axes:
        bench.homes[axis].is_done = True
    bench.turn()
    assert bench.single.homed == [(3 * MS, axis) for axis in axes]


# One axis


def find_home(drive: Drive) -> None:
    drive.statusword = ATTAINED | AT_REST


@pytest.mark.parametrize("mode_in_pdo", [False, True])
def test_breaking_off_a_homing_that_has_ended_changes_nothing(mode_in_pdo: bool) -> None:
    """Neither its mode is read or written again, nor its bits, nor the proof of its place."""
    drive = NotingDrive(mode_in_pdo=mode_in_pdo)
    axis, _ = homing(drive)
    find_home(drive)
    cycles(axis, 20 * SDO_CYCLES)
    assert axis.phase is Phase.DONE
    drive.modes.clear()
    drive.mode_bits, drive.is_placed = 0x40, True
    axis.abort()
    cycles(axis, 20 * SDO_CYCLES)
    assert (axis.phase, drive.modes) == (Phase.DONE, [])
    assert (drive.mode_bits, drive.is_placed) == (0x40, True)


@pytest.mark.parametrize("limit_ns", [S // 2, 3 * S])
def test_a_homing_may_take_exactly_as_long_as_its_limit(limit_ns: int) -> None:
    drive = Drive()
    axis, clock = homing(drive, limit_ns)
    cycles(axis, 4 * SDO_CYCLES + BLIND_CYCLES)
    clock.now_ns = limit_ns
    cycles(axis, 5)
    assert axis.phase is Phase.SEARCHING
    clock.now_ns += 1
    cycles(axis, 1)
    assert axis.phase is Phase.EXPLAINING


def test_what_is_found_in_time_counts_also_when_the_limit_is_over() -> None:
    """Bits of the drive go before the clock."""
    drive = Drive()
    axis, clock = homing(drive, S)
    cycles(axis, 4 * SDO_CYCLES + BLIND_CYCLES)
    clock.now_ns = 2 * S
    find_home(drive)
    cycles(axis, 1)
    assert axis.phase is Phase.PROVING


@pytest.mark.parametrize(("readings", "is_refused"), [(100, False), (101, True)])
def test_a_hundred_readings_may_show_the_mode_of_before(readings: int, is_refused: bool) -> None:
    assert MODE_POLLS_MAX == 100
    drive = SlowDrive(readings)
    axis, _ = homing(drive)
    steps = (readings + 4) * SDO_CYCLES
    if is_refused:
        with pytest.raises(Alarm, match=f"6061 shows mode {CSP}"):
            cycles(axis, steps)
    else:
        cycles(axis, steps)
        assert axis.phase is Phase.SEARCHING


def test_the_start_bit_is_there_from_mode_6_until_the_home_is_found() -> None:
    """Before, the drive would begin in its old mode; after, it would begin once more."""
    drive = Drive()
    axis, _ = homing(drive)
    shown = []
    for cycle in range(60):
        if cycle == 40:
            find_home(drive)
        axis.step()
        shown.append((drive.objects[0x6061], drive.mode_bits))
    assert [pair for k, pair in enumerate(shown) if not k or pair != shown[k - 1]] == [
        (CSP, 0), (HOMING, 0), (HOMING, 1 << 4), (HOMING, 0), (CSP, 0),
    ]  # fmt: skip
