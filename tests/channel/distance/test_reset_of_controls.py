"""A reset with distance control: it is off, the tool stays, and nothing is waited for."""

from collections.abc import Callable
from typing import Any

import pytest
from tests.channel.test_channel_reset import Side, begun, reset, start

from axisrig.kernel.distance import DistanceState

Make = Callable[..., Any]
HEIGHT_MM = 0.75
RESET, NEXT = 250, 300
"""The turns in which the PLC side resets, and in which it starts the next program."""


def raised(_time_ns: int) -> float:
    return HEIGHT_MM


def on(say: Any, **more: Any) -> Any:
    return say.command("on", set_pos_mm=0.0, **more)


LED_TO = {
    "ACTIVE": lambda say: [on(say)],
    "ACTIVE_CONST_DIST": lambda say: [
        say.command("on_const", set_dist_mm=say.start_mm), say.dwell(100),
    ],
    "FREEZE": lambda say: [on(say), say.dwell(200), say.command("freeze")],
    "TURNING_OFF": lambda say: [on(say), say.dwell(200), say.command("off")],
}  # fmt: skip


@pytest.mark.long
@pytest.mark.parametrize("state", LED_TO)
@pytest.mark.parametrize("is_optimized", [False, True])
def test_a_reset_switches_off_and_leaves_the_tool_where_it_is(
    distance_bench: Make, say: Any, words: Any, state: str, is_optimized: bool
) -> None:
    """The offset becomes part of the position (900560): the next program begins and ends by it."""
    made = distance_bench(raised, v_max_mm_s=5.0, is_optimized=is_optimized)
    target_mm = say.start_mm + 1.0
    after = start(made.bench, words.move(9, 600.0, Z=target_mm), words.end())
    Side(made.bench, words, {RESET: reset(made.bench), NEXT: after})
    made.run(*LED_TO[state](say), say.dwell(5000))
    seen = made.seen
    assert seen.state[RESET - 2] is DistanceState[state]
    assert set(seen.state[RESET + 2 :]) == {DistanceState.INACTIVE}
    assert made.alarm_ids == [900560]
    (warning,) = made.channel.alarms
    assert float(warning.values["offset_mm"]) == pytest.approx(seen.offset_mm[RESET - 1], abs=0.01)
    rest = seen.sent_mm[RESET + 2 : NEXT - 1]
    assert max(rest) - min(rest) < 1e-9
    assert abs(rest[0] - seen.sent_mm[RESET - 1]) <= 5.0 * 3e-3  # v_max in the cycles of the reset
    steps = [
        abs(b - a) for a, b in zip(seen.sent_mm[RESET:], seen.sent_mm[RESET + 1 :], strict=False)
    ]
    assert max(steps) <= 10.0 * 1e-3 + 1e-9  # the feed of the next program
    assert seen.sent_mm[-1] == pytest.approx(target_mm, abs=1e-9)


def test_the_set_values_of_the_old_program_are_forgotten(
    distance_bench: Make, say: Any, words: Any
) -> None:
    """70335: ON of the next program has no surface."""
    made = distance_bench(raised)
    after = start(made.bench, say.command("on"), say.dwell(20), words.end())
    Side(made.bench, words, {50: reset(made.bench), 100: after})
    made.run(say.command(set_pos_mm=0.0), say.dwell(5000))
    assert made.alarm_ids == [70335]


def test_the_next_program_does_not_wait_for_an_offset_that_ran_out_in_the_one_before(
    distance_bench: Make, say: Any, words: Any
) -> None:
    """OFF with WAIT takes 150 ms at 5 mm/s; the reset comes 50 ms after it."""
    made = distance_bench(raised, v_max_mm_s=5.0)
    after = start(made.bench, words.move(9, 600.0, Z=say.start_mm + 0.5), words.end())
    Side(made.bench, words, {RESET: reset(made.bench), RESET + 10: after})
    made.run(on(say), say.dwell(200), say.command("off", wait=True), words.move(8, 600.0, Z=0.0))
    z = made.bench.set_mm("Z")[begun(made.bench) :]
    assert z[RESET + 9] != z[RESET + 12]
    assert z[-1] == pytest.approx(say.start_mm + 0.5, abs=1e-9)


def test_a_reset_leads_out_of_an_error_and_the_next_program_switches_on_again(
    distance_bench: Make, say: Any, words: Any
) -> None:
    """A step of 3 mm where 1 mm is the largest deviation: ERROR until the reset."""
    height = [HEIGHT_MM]
    made = distance_bench(lambda _time_ns: height[0], max_deviation_mm=1.0)
    acts: dict[int, Callable[[], None]] = {
        50: lambda: height.__setitem__(0, 3.0),
        100: lambda: height.__setitem__(0, HEIGHT_MM),
        120: reset(made.bench),
        180: start(made.bench, on(say), say.dwell(20), words.end()),
    }
    Side(made.bench, words, acts)
    made.run(on(say), say.dwell(5000))
    states = made.seen.states()
    assert DistanceState.ERROR in states
    assert states[states.index(DistanceState.ERROR) :][:3] == [
        DistanceState.ERROR, DistanceState.INACTIVE, DistanceState.ACTIVE,
    ]  # fmt: skip
    assert len(made.channel.resets_ns) == 1
