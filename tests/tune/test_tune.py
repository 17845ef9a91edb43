"""`axisrig tune distance` on the shipped rig: what it measures, says and refuses."""

import json
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

from axisrig.bench.cli.main import app, main
from axisrig.bench.oracles.distance.stability import mean_limit
from axisrig.bench.tools.tune.distance import BOTH_ENCODERS, CONST_DIST, SET_POS, Mode, Tuning, tune
from axisrig.bench.tools.tune.loop import Law
from axisrig.bench.tools.tune.measure import Signals, Steps, choose, distance_step
from axisrig.bench.tools.tune.report import text_of, warnings_of
from axisrig.kernel.errors import UserError

RIGS = Path(__file__).parents[2] / "testplans" / "rigs"
RIG = RIGS / "distance-z.toml"
SERVO_STEP_MM = 0.5
DEFAULTS = ("kp=1", "filter_type=DEFAULT", "n_cycles=4")
Tune = Callable[..., Tuning]


@pytest.fixture(scope="module")
def tuned() -> Tune:
    """Return `tuned(parameters, others)`: the shipped rig with these, measured once."""
    known: dict[tuple[str, ...], Tuning] = {}

    def run(*parameters: str, others: tuple[str, ...] = (), step_mm: float | None = None) -> Tuning:
        changes = (*(f"set:Z.kenngr.distc.{text}" for text in parameters), *others)
        if changes not in known:
            known[changes] = tune(choose(RIG, None, None, changes), step_mm)
        return known[changes]

    return run


def mode(found: Tuning, name: str) -> Mode:
    return next(mode for mode in found.modes if mode.name == name)


@pytest.mark.long
@pytest.mark.parametrize(("is_optimized", "dead"), [(0, 2), (1, 1)])
def test_dead_time_is_that_of_the_scheduling(tuned: Tune, is_optimized: int, dead: int) -> None:
    found = tuned(*DEFAULTS, f"optimized_scheduling={is_optimized}")
    assert found.dead_time.dead == dead
    assert (found.dead_time.reaction, found.dead_time.way) == (1 - is_optimized, 2)
    assert found.distance.is_dead_time
    assert found.distance.mean_cycle == dead + 1
    # From the frame behind the NC cycle at 0.6 ms to the one behind the SYNC two periods on
    assert found.dead_time.way_ns is not None
    assert 1.4e6 <= found.dead_time.way_ns <= 2.0e6


@pytest.mark.long
@pytest.mark.parametrize(("is_optimized", "dead"), [(0, 2), (1, 1)])
def test_limits_are_those_of_the_closed_forms(tuned: Tune, is_optimized: int, dead: int) -> None:
    found = tuned(*DEFAULTS, f"optimized_scheduling={is_optimized}")
    expected = {
        CONST_DIST: mean_limit(4, dead),
        BOTH_ENCODERS: mean_limit(4, dead - 1),
        SET_POS: 2.0,
    }
    for name, limit in expected.items():
        assert mode(found, name).stable_kp[1] == pytest.approx(limit, rel=1e-3)
        assert mode(found, name).closed_limit == pytest.approx(limit)


@pytest.mark.long
def test_the_default_is_unstable_in_const_dist_and_the_best_in_set_pos(tuned: Tune) -> None:
    found = tuned(*DEFAULTS, "optimized_scheduling=1")
    assert not mode(found, CONST_DIST).is_stable
    surface = mode(found, SET_POS)
    assert surface.is_stable
    assert surface.advice is not None
    assert surface.advice.law.kp == 1.0
    outcome = list(warnings_of(found))
    assert len(outcome) == 1
    assert "CONST_DIST with kp 1" in outcome[0]
    assert "filter DEFAULT, 4 values is unstable with 1 cycle of dead time" in outcome[0]
    assert "only kp below 0.619 is stable" in outcome[0]


@pytest.mark.long
def test_the_suggested_law_does_what_was_predicted(tuned: Tune) -> None:
    found = tuned(*DEFAULTS, "optimized_scheduling=1")
    assert found.trial is not None
    assert np.abs(found.trial.seen - found.trial.predicted).max() < 1e-3
    assert found.trial.seen.max() < 1.021


@pytest.mark.long
def test_a_stable_list_gives_no_warning(tuned: Tune) -> None:
    assert list(warnings_of(tuned("kp=0.1"))) == []


@pytest.mark.long
def test_noise_is_told_and_does_not_hide_the_dead_time(tuned: Tune) -> None:
    """At 2 mm the noise of the plant is 4 times that at 1 mm."""
    noise = ("plant:gap.noise_um=1",)
    found = tuned(*DEFAULTS, "optimized_scheduling=1", others=noise)
    assert found.distance.sigma_mm == pytest.approx(4e-3, rel=0.3)
    assert found.step_mm == pytest.approx(100 * found.distance.sigma_mm, rel=0.3)
    assert found.dead_time.dead == 1
    assert mode(found, CONST_DIST).stable_kp[1] == pytest.approx(mean_limit(4, 1), rel=0.02)


@pytest.mark.long
@pytest.mark.parametrize("bandwidth_hz", [20, 100])
def test_a_slow_sensor_lowers_the_limit(tuned: Tune, bandwidth_hz: int) -> None:
    """Its first-order lag at the SYNC, e^-wT, over the ramp of the drive: exact in closed form."""
    others = ("plant:gap.order=1", f"plant:gap.bandwidth={bandwidth_hz}")
    found = tuned(*DEFAULTS, "optimized_scheduling=1", "filter_type=MOVING_AVERAGE", others=others)
    w = 2 * np.pi * bandwidth_hz * found.period_s
    # Answer of a lag to a ramp over one period, then exponential
    first = 1 - (1 - np.exp(-w)) / w
    later = (1 - np.exp(-w)) ** 2 / w * np.exp(-w * np.arange(300))
    expected = np.concatenate([[0.0, 0.0, first], later])
    assert not found.distance.is_dead_time
    assert mode(found, CONST_DIST).closed_limit is None
    answer = np.cumsum(found.distance.impulses)
    assert np.abs(answer - np.cumsum(expected)[: len(answer)]).max() < 2e-3


@pytest.mark.long
@pytest.mark.parametrize(
    ("rig", "variable", "dead", "renewal"),
    [
        ("distance-z-2ms.toml", None, 2, 1),
        ("distance-z-event.toml", None, 2, 1),
        ("distance-z-every-second.toml", None, 3, 2),
        ("distance-z-variable.toml", "V.E.SENSOR", 2, 1),
        ("distance-z-variable-late.toml", "V.E.SENSOR", 4, 1),
    ],
)
def test_dead_time_of_other_telegrams_and_of_variables(
    rig: str, variable: str | None, dead: int, renewal: int
) -> None:
    """60E4 with every second SYNC is up to a cycle older; the variable two, as its rig says."""
    found = tune(choose(RIGS / rig, None, variable, ()))
    assert (found.dead_time.dead, found.dead_time.renewal) == (dead, renewal)
    assert (found.dead_time.way_ns is None) == (variable is not None)
    # A variable is a whole number of 0.1 um
    expected = pytest.approx(mean_limit(4, dead), rel=1e-3)
    assert mode(found, CONST_DIST).stable_kp[1] == expected
    assert mode(found, CONST_DIST).closed_limit == pytest.approx(mean_limit(4, dead))


@pytest.fixture(scope="module")
def servo() -> Tuning:
    """An axis with friction and a cascade of loops, whose sensor has no noise.

    The steps are high against the friction, which holds an axis within some um.
    """
    bench = choose(RIGS / "distance-z-servo.toml", None, None, ("plant:gap.noise_um=0",))
    return tune(bench, SERVO_STEP_MM)


def _stepped(servo: Tuning, kp: float) -> Signals:
    steps = Steps(1, 400, servo.period_s)
    run = distance_step(servo.bench, Law(kp), servo.rest_mm, SERVO_STEP_MM, steps)
    return run.signals


@pytest.mark.long
def test_below_the_limit_of_a_real_axis_a_step_dies_away(servo: Tuning) -> None:
    signals = _stepped(servo, 0.8 * mode(servo, CONST_DIST).stable_kp[1])
    began = int(np.flatnonzero(np.abs(np.diff(signals.wanted_mm)) > 0)[0])
    error = np.abs(signals.distance_mm[began : began + 400] - servo.rest_mm - SERVO_STEP_MM)
    assert error[300:400].max() < 0.2 * error[20:120].max()


@pytest.mark.long
def test_above_the_limit_of_a_real_axis_a_step_grows_until_the_sensor_ends(servo: Tuning) -> None:
    """From 0.5 mm to 1.9 mm, where the window of the sensor ends."""
    with pytest.raises(UserError, match="70330"):
        _stepped(servo, 1.2 * mode(servo, CONST_DIST).stable_kp[1])


@pytest.mark.long
def test_the_answer_of_a_real_axis_is_predicted(servo: Tuning) -> None:
    assert not servo.distance.is_dead_time
    assert servo.trial is not None
    assert servo.trial.misfit_mm < 0.02 * servo.step_mm


def test_text_says_what_was_found(tuned: Tune) -> None:
    text = text_of(tuned(*DEFAULTS, "optimized_scheduling=1"))
    assert "n = 1 cycle: an offset is sent in its own cycle and is seen 2 cycles after that" in text
    assert "kp < 0.6188; closed form 0.6188" in text
    assert "UNSTABLE" in text
    assert max(len(line) for line in text.splitlines()) <= 110


@pytest.mark.long
def test_a_sensor_of_the_wrong_sign_is_refused() -> None:
    bench = choose(RIG, None, None, ("set:Z.lr_hw[1].vz_istw=0",))
    with pytest.raises(UserError, match=r"opposite and equal.*P-AXIS-00230"):
        tune(bench)


@pytest.mark.long
def test_a_sensor_of_the_wrong_scale_is_refused() -> None:
    bench = choose(RIG, None, None, ("set:Z.lr_hw[1].encoder_resolution_num=20",))
    with pytest.raises(UserError, match=r"opposite and equal.*P-AXIS-00422"):
        tune(bench)


@pytest.mark.parametrize(
    ("rig", "axis", "changes", "words"),
    [
        ("distance-z.toml", "X", (), "no such axis"),
        ("probe-z.toml", None, (), "no axis of the rig has distance control"),
        ("probe-z.toml", "Z", (), "not released"),
    ],
)
def test_what_cannot_be_tuned(
    rig: str, axis: str | None, changes: tuple[str, ...], words: str
) -> None:
    with pytest.raises(UserError, match=words):
        choose(RIGS / rig, axis, None, changes)


def _invoke(*arguments: str) -> Any:
    return CliRunner().invoke(app, ["tune", "distance", "--rig", str(RIG), *arguments])


@pytest.mark.long
def test_command_writes_picture_and_json(tmp_path: Path) -> None:
    picture = tmp_path / "loop.svg"
    ended = _invoke("--json", "--picture", str(picture), "--set", "set:Z.kenngr.distc.kp=1")
    assert ended.exit_code == 0
    outcome = json.loads(ended.stdout)
    assert outcome["dead_cycles"] == 2
    assert [found["is_stable"] for found in outcome["modes"]] == [False, False, True]
    assert "warning: CONST_DIST with kp 1" in ended.stderr
    drawn = picture.read_text("utf-8")
    for words in ("suggested", "as configured", "answer to a step of the offset"):
        assert words in drawn


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--picture", "loop.bmp"), "no kind of picture"),
        (("--variable", "V.E.NOTHING"), "V.E.NOTHING"),
        (("--step", "0"), "step"),
    ],
)
def test_command_refuses(arguments: tuple[str, ...], words: str, tmp_path: Path) -> None:
    extra = () if "--picture" in arguments else ("--picture", str(tmp_path / "loop.svg"))
    ended = _invoke(*arguments, *extra)
    assert ended.exit_code == 2
    assert words in ended.stderr
    assert "Traceback" not in ended.stderr


@pytest.mark.long
def test_without_matplotlib_the_message_says_how_to_get_it(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.delitem(sys.modules, "axisrig.bench.tools.tune.picture", raising=False)
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    with pytest.raises(SystemExit) as ended:
        main(["tune", "distance", "--rig", "nothing.toml"])
    assert ended.value.code == 2
    assert "pip install 'axisrig[tune]' brings it" in capsys.readouterr().err
