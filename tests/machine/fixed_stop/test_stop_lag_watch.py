"""Lag monitoring of the CNC (lag_limit_mm of the rig, 900036) around a run to a fixed stop.

10 mm/s against a stop at 120 mm, 40 % torque. Without feed-forward and with P-AXIS-00191 = 2 the
running lag e0 is v/Kv = 0.25 mm; behind the contact it is e0 + v (t - t_c) - d, d the penetration
(physics 2(c), (d)).
"""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from tests.machine.conftest import Outcome
from tests.machine.fixed_stop.conftest import RunStop

LAG = {"pos_lag_limit": 15_000, "min_time": 100_000}  # 1.5 mm, 100 ms
LIMIT_MM, FEED_MM_S, STOP_MM, RUNNING_MM = 0.5, 10.0, 120.0, 0.25
GIVEN = (f"drive:servo.lag_limit_mm={LIMIT_MM}", "plant:z.position_start_mm=100")
PRESS = "N200 G1 Z150 F600"
RunNc = Callable[..., Outcome]


def alarm_ns(outcome: Outcome, alarm_id: int) -> int:
    channel = outcome.machine.channel
    pairs = zip(channel.alarm_ns, channel.alarms, strict=True)
    return next(time_ns for time_ns, alarm in pairs if alarm.id == alarm_id)


def due_ns(outcome: Outcome) -> float:
    """When the lag of a running axis passes the limit at the stop; truth is the plant's own."""
    times, truth_mm = outcome.column("time_ns"), outcome.column("Z.truth_mm")
    row = int((truth_mm > STOP_MM).argmax())
    share = (STOP_MM - truth_mm[row - 1]) / (truth_mm[row] - truth_mm[row - 1])
    contact_ns = float(times[row - 1] + share * (times[row] - times[row - 1]))
    behind_ns = (LIMIT_MM - RUNNING_MM) / FEED_MM_S * 1e9
    depth_mm = truth_mm[np.searchsorted(times, contact_ns + behind_ns)] - STOP_MM
    return contact_ns + behind_ns + depth_mm / FEED_MM_S * 1e9


def comes_up_on_time(outcome: Outcome) -> None:
    """In the cycle behind the first SYNC that samples such a lag."""
    timing = outcome.machine.timing
    sampled_ns = due_ns(outcome) + timing.period_ns / 2 + timing.offset_ns
    assert alarm_ns(outcome, 900036) == pytest.approx(sampled_ns, abs=0.75 * timing.period_ns)


@pytest.mark.provokes(900036, 7, axis="Z", limit_mm="0.5")
@pytest.mark.long
def test_without_type_7_the_same_press_is_900036(run_nc: RunNc) -> None:
    given = ("plant:z.stop_position_mm=120", "plc:Z.torque_limit=400", *GIVEN)
    pressed = run_nc(PRESS, "", *given, base="drive-functions.toml")
    assert pressed.alarms == [900036]
    comes_up_on_time(pressed)


@pytest.mark.long
def test_in_the_run_it_is_off_until_the_axis_is_back_in_its_window(run_stop: RunStop) -> None:
    found = run_stop(STOP_MM, *GIVEN, end="N200 G4 0.1", **LAG)
    assert found.alarms == []
    times, lag_mm = found.outcome.column("time_ns"), found.outcome.column("Z.cnc_lag_mm")
    begin_ns, end_ns = found.stop.relax_begin_ns, found.stop.watch_on_ns
    assert begin_ns is not None
    assert end_ns == found.record.end_ns
    assert abs(lag_mm).max() > 2.5  # 1.5 mm and 100 ms of 10 mm/s
    back = (times >= begin_ns) & (times < end_ns)
    assert abs(lag_mm[back]).max() > 2.0
    assert abs(lag_mm[times >= end_ns]).max() < 0.01


@pytest.mark.provokes(900036, 7, axis="Z", limit_mm="0.5")
@pytest.mark.long
def test_directly_behind_the_run_it_is_on_again(run_stop: RunStop) -> None:
    """The axis is at the stop already: e is what the set value has gone on, 0.5 mm."""
    found = run_stop(STOP_MM, *GIVEN, end=PRESS, **LAG)
    assert found.alarms == [900036]
    outcome, period_ns = found.outcome, found.outcome.machine.timing.period_ns
    times, set_mm = outcome.column("time_ns"), outcome.column("Z.set_mm")
    assert found.record.end_ns is not None
    first = int(((times > found.record.end_ns) & (set_mm > found.stop.actual_mm["Z"])).argmax())
    listed = outcome.machine.settings.axis["Z"]
    ramp_s = FEED_MM_S / listed.mm_s2("getriebe[0].lslope_profil.a_stufe_1")
    gone_s = LIMIT_MM / FEED_MM_S + ramp_s / 2
    sent_ns = times[first] + gone_s * 1e9
    # That row has gone one cycle already; compared two cycles of P-AXIS-00191 later
    wanted_ns = sent_ns + 1.5 * period_ns + outcome.machine.timing.offset_ns
    assert alarm_ns(outcome, 900036) == pytest.approx(wanted_ns, abs=0.75 * period_ns)


@pytest.mark.provokes(900036, 7, axis="Z", limit_mm="0.5")
@pytest.mark.long
def test_behind_a_run_that_found_nothing_it_is_on_again(run_stop: RunStop) -> None:
    goes_on = "set:channel.meas_fixed_stop_no_error=1"
    missed = run_stop(STOP_MM, goes_on, *GIVEN, target=110, end=PRESS, **LAG)
    assert missed.outcome.printed("MERF") == [0]
    assert missed.alarms == [900036]
    comes_up_on_time(missed.outcome)


@pytest.mark.long
def test_behind_an_alarm_it_is_on_again(run_stop: RunStop) -> None:
    seen: list[tuple[int, bool]] = []

    def watch(channel: Any) -> None:
        (link,) = channel.links
        seen.append((channel._clock.now_ns, link.watches_lag))

    missed = run_stop(STOP_MM, *GIVEN, target=110, watch=watch, **LAG)
    assert missed.alarms == [900240]
    ended_ns = alarm_ns(missed.outcome, 900240)
    assert missed.stop.watch_on_ns == ended_ns
    off_ns = missed.stop.watch_off_ns
    assert off_ns is not None
    assert {on for time_ns, on in seen if off_ns <= time_ns < ended_ns} == {False}
    assert {on for time_ns, on in seen if time_ns >= ended_ns} == {True}
    assert {on for time_ns, on in seen if time_ns < off_ns} == {True}
