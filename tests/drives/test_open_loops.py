"""Where the CNC closes the position loop: when the loop is open, and when it is closed again.

A link with telegrams by hand. Kv 10 1/s and no feed-forward: 1 mm of lag is a set speed of 10 mm/s,
an open loop has the speed of the set positions alone.
"""

import pytest
from tests.drives.test_link_by_hand import OPERATION_ENABLED, Wire, _link
from tests.drives.test_position_loop import KV, PERIOD_S, cycle

from axisrig.kernel.drives.canopen.link import AxisLink
from axisrig.kernel.drives.frozen_encoder import STANDS_S
from axisrig.kernel.drives.position_loop import LoopSettings
from axisrig.kernel.drives.position_watch import jump_alarm, lag_alarm

FROZEN_CYCLES = round(STANDS_S / PERIOD_S)
SWITCHED_ON, QUICK_STOP, FAULT = 0x1233, 0x1217, 0x0218
LED = round(KV * 1000.0)
"""60FF for 1 mm of lag, in increments per second."""


def following(**settings: float) -> tuple[AxisLink, Wire]:
    """A drive in operation at 4 mm, led to 5 mm."""
    link, wire = _link(loop=LoopSettings(KV, PERIOD_S), **settings)
    assert cycle(link, wire, OPERATION_ENABLED, 4000, 5.0) == LED
    return link, wire


def held(link: AxisLink, wire: Wire, cycles: int, increments: int = 4000) -> list[int]:
    """The speeds of some cycles in which nothing moves."""
    return [cycle(link, wire, OPERATION_ENABLED, increments, 5.0) for _ in range(cycles)]


def test_an_axis_at_a_fixed_stop_stands_as_long_as_it_wants_and_is_watched_again_after_it() -> None:
    link, wire = following()
    for _ in range(2):
        link.watches_lag = False
        assert held(link, wire, 3 * FROZEN_CYCLES) == [LED] * 3 * FROZEN_CYCLES
        assert not link.runs_open
        link.watches_lag = True
        assert held(link, wire, 1, 4001) == [LED - 10]
        assert held(link, wire, FROZEN_CYCLES - 1, 4001) == [LED - 10] * (FROZEN_CYCLES - 1)
        assert not link.runs_open
        assert held(link, wire, 2, 4001) == [0, 0]
        assert link.runs_open
        link.close_loop()
        assert held(link, wire, 1, 4000) == [LED]


def test_a_run_to_a_fixed_stop_begins_the_time_of_the_watch_anew() -> None:
    """45 ms without a count before the run and 45 ms after it are no 50 ms."""
    link, wire = following()
    for _ in range(4):
        held(link, wire, FROZEN_CYCLES - 5)
        link.watches_lag = False
        held(link, wire, 1)
        link.watches_lag = True
    assert not link.runs_open


@pytest.mark.parametrize("watches", [True, False])
def test_after_a_jump_the_set_positions_alone_count_until_the_loop_is_closed(watches: bool) -> None:
    """2 mm at once, back again, and on: no actual position is believed any more."""
    link, wire = following(jump_mm=1.0)
    link.watches_lag = watches
    for place, set_mm, speed in (
        (6000, 5.0, 0), (4000, 5.01, 10_000), (4001, 5.03, 20_000), (4001, 5.03, 0),
    ):  # fmt: skip
        assert cycle(link, wire, OPERATION_ENABLED, place, set_mm) == speed
        assert link.runs_open
    link.close_loop()
    assert not link.runs_open
    assert cycle(link, wire, OPERATION_ENABLED, 4001, 5.03) == round(KV * 1029)


@pytest.mark.parametrize("word", [SWITCHED_ON, QUICK_STOP, FAULT])
def test_a_drive_that_does_not_follow_closes_the_loop(word: int) -> None:
    link, wire = following(jump_mm=1.0)
    assert cycle(link, wire, OPERATION_ENABLED, 6000, 5.0) == 0
    assert link.runs_open
    assert cycle(link, wire, word, 6000, 5.0) == 0
    assert not link.runs_open
    assert cycle(link, wire, OPERATION_ENABLED, 6000, 6.5) == round(KV * 500)


def test_a_jump_is_reported_once_and_in_operation_alone() -> None:
    link, wire = following(jump_mm=1.0)
    assert jump_alarm(link) is None
    cycle(link, wire, OPERATION_ENABLED, 6500, 5.0)
    found = jump_alarm(link)
    assert found is not None
    assert (found.id, found.values["jump_mm"]) == (900029, "2.500")
    assert jump_alarm(link) is None
    cycle(link, wire, OPERATION_ENABLED, 4000, 5.0)
    cycle(link, wire, FAULT, 4000, 5.0)
    assert jump_alarm(link) is None  # the drive stands by itself
    cycle(link, wire, OPERATION_ENABLED, 4000, 4.0)
    assert jump_alarm(link) is None  # and what was then is forgotten


@pytest.mark.parametrize("missing", [0, 1, 3])
@pytest.mark.parametrize(("beyond", "jumps"), [(0, False), (1, True)])
@pytest.mark.parametrize("sign", [1, -1])
def test_a_jump_is_more_than_the_way_of_all_cycles_since_the_last_position(
    missing: int, beyond: int, jumps: bool, sign: int
) -> None:
    """1 mm a cycle: with one more for each cycle without a telegram."""
    link, wire = _link(jump_mm=1.0)
    wire.status(OPERATION_ENABLED, 0)
    wire.latch()
    link.take()
    for _ in range(missing):
        wire.latch()
        link.take()
    wire.status(OPERATION_ENABLED, sign * (1000 * (missing + 1) + beyond))
    wire.latch()
    link.take()
    assert (link.jump_mm is not None, link.has_jumped) == (jumps, jumps)


def test_the_first_position_and_one_of_a_new_reference_are_no_jumps() -> None:
    link, wire = _link(jump_mm=1.0)
    for place, may_jump in ((90_000, False), (-5000, True), (-5000, False)):
        link.may_jump = may_jump
        cycle(link, wire, OPERATION_ENABLED, place, 0.0)
        assert link.jump_mm is None
    cycle(link, wire, OPERATION_ENABLED, 90_000, 0.0)
    assert link.jump_mm == 95.0


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize(("lag", "is_alarm"), [(500, False), (501, True)])
def test_a_lag_beyond_the_limit_of_the_rig_is_an_alarm_in_both_directions(
    sign: int, lag: int, is_alarm: bool
) -> None:
    link, wire = _link(lag_limit_mm=0.5)
    cycle(link, wire, OPERATION_ENABLED, 4000 - sign * lag, 4.0)
    found = lag_alarm(link)
    assert (found is not None) is is_alarm
    assert found is None or (found.id, found.values["lag_mm"]) == (900036, f"{sign * 0.501:.4f}")
    link.watches_lag = False
    assert lag_alarm(link) is None
    link.watches_lag = True
    assert (lag_alarm(link) is not None) is is_alarm


def test_an_encoder_that_counts_nothing_is_the_alarm_before_its_lag() -> None:
    link, wire = following(lag_limit_mm=0.5)
    found = lag_alarm(link)
    assert found is not None
    assert found.id == 900036
    held(link, wire, FROZEN_CYCLES)
    found = lag_alarm(link)
    assert found is not None
    assert (found.id, found.values["speed_mm_s"], found.values["time_ms"]) == (900037, "10", "50")
