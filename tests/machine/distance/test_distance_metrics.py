"""What metrics of distance control say where they have no number, and where a fault would hide."""

from collections.abc import Callable
from typing import Any

import pytest

from axisrig.bench.judge.observed.observation import Observation
from axisrig.bench.judge.topics import DISTANCE_METRICS, observe
from axisrig.bench.plan.checks import known_metrics, parse_check

LEVEL = "Z[DIST_CTRL ON CONST_DIST SET_DIST=1.9]\nG04 0.3\nZ[DIST_CTRL OFF NO_MOVE]"
STEEP = ("set:Z.kenngr.distc.v_max=500000", "set:Z.kenngr.distc.a_max=10000000")
RAMP = ("plant:gap.lift_mm=1", "plant:gap.lift_begin_ms=60", "plant:gap.lift_end_ms=260")


@pytest.fixture
def found(run_nc: Callable[..., Any]) -> Callable[..., Callable[[str], Observation]]:
    """Return `run(program, *assignments)`, which returns what a metric tells of that run."""

    def run(program: str, *assignments: str, base: str = "distance-z.toml") -> Any:
        observed = run_nc(program, "", *assignments, base=base).observed
        return lambda metric: observe(observed, parse_check(metric, _condition(metric), "here"))

    return run


def _condition(metric: str) -> str:
    words = known_metrics()[metric.partition(":")[0]].words
    return f"== {words.split()[0]}" if words else "!= 0"


def text_of(seen: Observation) -> str:
    assert seen.value is None
    return seen.note


def test_every_metric_of_distance_control_is_in_the_table() -> None:
    """Those of rotary axes are their twins."""
    known = {
        name: metric.linear
        for name, metric in known_metrics().items()
        if name.startswith(("distance_", "offset_", "freeze"))
    }
    assert set(DISTANCE_METRICS) == {name for name, linear in known.items() if not linear}
    assert {linear for linear in known.values() if linear} <= set(DISTANCE_METRICS)


def test_without_distance_control(found: Any) -> None:
    of = found("G04 0.02", base="probe-z.toml")
    for name in DISTANCE_METRICS:
        assert "no axis has it" in text_of(of(name))
    assert "axis Z has no distance control" in text_of(of("offset_end_mm:Z"))


def test_never_switched_on(found: Any) -> None:
    of = found("G04 0.02")
    for name in ("distance_growth", "distance_kp_limit", "distance_behind_um_max"):
        assert "never on" in text_of(of(name))
    assert "never frozen" in text_of(of("freeze_drift_um"))
    assert "neither feedhold" in text_of(of("offset_held_drift_um"))
    assert of("distance_state_end").value == "INACTIVE"


@pytest.mark.long
def test_a_level_surface_has_no_step_to_measure_dead_cycles_with(found: Any) -> None:
    of = found(LEVEL)
    assert text_of(of("distance_dead_cycles"))
    assert of("distance_dead_cycles_expected").value == 2
    assert "none, raised: none" in text_of(of("distance_alarm_late_cycles"))
    assert of("distance_error_expected_um").value == pytest.approx(0.0)
    assert of("offset_model_error_um").value == pytest.approx(0.0, abs=1e-9)


def test_an_unstable_loop_has_no_closed_form_of_its_error(found: Any) -> None:
    of = found(
        LEVEL.replace("1.9]", "1.995]").replace("0.3", "0.05"), *STEEP, "set:Z.kenngr.distc.kp=1"
    )
    assert "not stable" in text_of(of("distance_error_expected_um"))
    assert of("distance_stability").value == "unstable"
    assert of("distance_growth").value == pytest.approx(
        of("distance_growth_expected").value, abs=2e-3
    )


@pytest.mark.long
def test_a_transient_that_is_not_over_is_told(found: Any) -> None:
    of = found(LEVEL.replace("1.9]", "2]"), *STEEP, *RAMP, "set:Z.kenngr.distc.kp=0.005")
    assert "the transient needs" in text_of(of("distance_error_expected_um"))
    assert "the transient needs" in text_of(of("distance_behind_expected_um"))


@pytest.mark.long
def test_a_limit_that_acts_is_named(found: Any) -> None:
    of = found(LEVEL.replace("1.9]", "2]"), *RAMP, "set:Z.kenngr.distc.v_max=4000")
    assert "limited" in text_of(of("distance_error_expected_um"))
    assert of("offset_speed_mm_s_max").value == pytest.approx(4.0)


@pytest.mark.long
def test_a_telegram_that_comes_seldom_has_no_limit_of_kp(found: Any) -> None:
    of = found(LEVEL, base="distance-z-every-second.toml")
    assert "every SYNC" in text_of(of("distance_kp_limit"))
    assert "every SYNC" in text_of(of("distance_growth_expected"))


@pytest.mark.long
def test_a_surface_that_stands_is_no_sine(found: Any) -> None:
    of = found(LEVEL)
    assert "fewer than two periods" in text_of(of("distance_sine_gain"))
    assert "fewer than two periods" in text_of(of("distance_sine_gain_expected"))
