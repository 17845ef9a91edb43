"""A run to a fixed stop on a real plant, against the plant's own numbers and closed forms."""

import pytest
from tests.machine.fixed_stop.conftest import RunStop

from axisrig.bench.judge.fixed_stop.findings import stop_findings

LAG_LIMIT, MIN_TIME = 15_000, 100_000  # 1.5 mm, 100 ms


@pytest.mark.long
def test_the_run_ends_with_the_axis_at_the_stop_and_without_lag(run_stop: RunStop) -> None:
    found = run_stop(120, pos_lag_limit=LAG_LIMIT, min_time=MIN_TIME)
    assert found.alarms == []
    assert found.outcome.printed("MERF") == [1]
    assert found.outcome.printed("MESS") == [pytest.approx(found.record.latched_mm["Z"], abs=1e-8)]
    assert found.outcome.printed("ABS") == [pytest.approx(found.record.latched_mm["Z"], abs=1e-8)]
    assert found.stop.watch_on_ns == found.record.end_ns


@pytest.mark.provokes(900240, 4, axes="Z")
@pytest.mark.long
def test_900240_without_a_stop_says_what_was_looked_for(run_stop: RunStop) -> None:
    """10 mm/s, kv 40: the lag of a running axis is v/kv, and P-AXIS-00191 takes the rest off."""
    missed = run_stop(None, pos_lag_limit=LAG_LIMIT, min_time=MIN_TIME)
    assert missed.alarms == [900240]
    (alarm,) = missed.outcome.machine.channel.alarms
    assert "Z lag > 1.5 mm, no window, min_time 100 ms, largest lag 0.25" in str(alarm)


@pytest.mark.long
def test_without_a_stop_the_program_goes_on_by_p_chan_00266(run_stop: RunStop) -> None:
    wanted = "set:channel.meas_fixed_stop_no_error=1"
    missed = run_stop(None, wanted, pos_lag_limit=LAG_LIMIT, min_time=MIN_TIME)
    assert missed.alarms == []
    assert missed.outcome.printed("MERF") == [0]
    assert missed.outcome.printed("ABS") == [pytest.approx(150, abs=1e-4)]


@pytest.mark.provokes(51026, 2, axis="Z", value_permille=1001, limit_permille=1000)
@pytest.mark.provokes(110757, 1, axis="Z")
def test_51026_at_the_start_of_a_run_behind_110757_at_start_up(run_stop: RunStop) -> None:
    refused = run_stop(120, pos_lag_limit=LAG_LIMIT, start_distance_per_mille=1001)
    assert refused.alarms == [110757, 51026]
    assert refused.outcome.machine.channel.records == []


@pytest.mark.parametrize(
    ("before", "has_form"),
    [
        ("N5 #SLOPE [TYPE=SIN2]\n", False),
        pytest.param("", True, marks=pytest.mark.long),
        pytest.param("N5 G130 Z50\n", False, marks=pytest.mark.long),
    ],
)
@pytest.mark.long
def test_closed_forms_of_the_listed_slope_are_not_of_one_that_the_program_chose(
    run_stop: RunStop, before: str, *, has_form: bool
) -> None:
    found = run_stop(120, before=before, pos_lag_limit=LAG_LIMIT, min_time=MIN_TIME)
    (answer,) = stop_findings(found.outcome.observed)
    (excess,) = (value for value in answer.values if value.key == "command_excess")
    assert has_form or excess.expected is None
    assert ("#SLOPE" in answer.prediction) != has_form
    assert answer.prediction.startswith("contact of Z") == has_form
