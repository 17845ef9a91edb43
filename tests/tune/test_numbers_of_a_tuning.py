"""Each number of a tuned axis by its own name: in the text, in the data and in the picture."""

import json
from dataclasses import replace
from pathlib import Path as File
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from matplotlib.figure import Figure
from tests.tune.test_findings import ADVICE, found, mode

from axisrig.bench.tools.tune.distance import (
    BOTH_ENCODERS,
    CONST_DIST,
    SET_POS,
    DeadTime,
    Trial,
    Tuning,
)
from axisrig.bench.tools.tune.identify import Path
from axisrig.bench.tools.tune.loop import Law
from axisrig.bench.tools.tune.picture import _bode, _path, _steps
from axisrig.bench.tools.tune.report import data_of, text_of, warnings_of
from axisrig.kernel.distance.filters import FilterSettings

SLOW = np.array([0.0, 0.25, 0.25, 0.25, 0.25])
"""A quarter of the step in each of cycles 1 to 4: settled after 4, its centre at 2.5."""


def tuned(**given: Any) -> Tuning:
    """All numbers differ: 4 ms, steps of 0.08 mm at 1.5 mm, noise 0.3 um, misfit 0.2 um."""
    values: dict[str, Any] = {
        "bench": SimpleNamespace(axis="W", rig=File("rigs/own.toml"), variable="V.E.GAP"),
        "period_s": 4e-3, "rest_mm": 1.5, "step_mm": 0.08,
        "distance": Path(SLOW, 3e-4, 2e-4), "actual": Path(SLOW, 5e-4, 6e-4),
        "dead_time": DeadTime(reaction=3, way=5, renewal=2, way_ns=2_250_000),
    }  # fmt: skip
    return found(**(values | given))


def test_data_have_each_number_under_its_own_name() -> None:
    data = data_of(tuned())
    assert {name: data[name] for name in data if name not in ("modes", "warnings")} == {
        "axis": "W", "rig": str(File("rigs/own.toml")), "variable": "V.E.GAP", "period_s": 4e-3,
        "step_mm": 0.08, "noise_mm": 3e-4, "filter": "MOVING_AVERAGE, 4 values",
        "dead_cycles": tuned().dead_time.dead, "reaction_cycles": 3, "way_cycles": 5,
        "way_ns": 2_250_000, "renewal_cycles": 2,
        "answer": {"is_dead_time": False, "settled_cycles": 4, "mean_cycles": 2.5, "gain": 1.0},
    }  # fmt: skip
    assert data["warnings"] == list(warnings_of(tuned()))
    json.dumps(data)


def test_data_of_a_mode_have_its_limits_its_closed_form_and_what_it_lacks() -> None:
    plain = replace(mode(CONST_DIST, 0.75, advice=None), closed_limit=0.8, stable_kp=(0.1, 0.75))
    other = mode(SET_POS, 2.0, is_stable=False)
    first, second = data_of(tuned(modes=(plain, other)))["modes"]
    assert first == {
        "name": CONST_DIST, "is_chosen": True, "is_stable": True, "stable_kp": [0.1, 0.75],
        "closed_form_kp": 0.8, "suggested": None, "reasons": [],
        "configured": {"kp": 0.2, "i_tn_s": 0.0, "d_tv_s": 0.0},
    }  # fmt: skip
    assert (second["is_chosen"], second["is_stable"]) == (False, False)
    assert second["closed_form_kp"] is None
    assert second["suggested"] == {"kp": 0.25, "i_tn_s": 0.0, "d_tv_s": 0.002}


def test_the_text_has_the_step_the_rest_the_noise_and_the_sensor() -> None:
    lines = text_of(tuned()).splitlines()
    assert lines[0] == f"axis W of {File('rigs/own.toml')}: variable V.E.GAP, cycle 4 ms"
    assert lines[1] == (
        "measured with steps of 80 um at a distance of 1.5000 mm; noise of the sensor 0.3 um"
    )
    bare = tuned(bench=SimpleNamespace(axis="W", rig=File("a.toml"), variable=None))
    assert text_of(bare).startswith("axis W of a.toml: second encoder (60E4), cycle 4 ms")


@pytest.mark.parametrize(("period_s", "centre_ms"), [(1e-3, "2.5"), (4e-3, "10.0")])
def test_the_centre_of_a_slow_answer_is_in_cycles_and_in_ms(
    period_s: float, centre_ms: str
) -> None:
    (line,) = (line for line in text_of(tuned(period_s=period_s)).splitlines() if "longer" in line)
    assert line.strip() == (
        f"the answer takes longer: 98 % after 4 cycles, centre 2.5 cycles ({centre_ms} ms)"
    )


@pytest.mark.parametrize(
    ("most", "share"), [(1.25, "25.0%"), (1.0, "0.0%"), (0.9, "0.0%"), (1.004, "0.4%")]
)
def test_a_trial_says_how_far_a_step_is_passed_and_how_well_that_was_known(
    most: float, share: str
) -> None:
    trial = Trial(Law(0.3, 0.05, 0.001), np.array([0.0, 9.0]), np.array([0.5, most]), 0.0012)
    lines = text_of(tuned(trial=trial)).splitlines()
    at = next(n for n, line in enumerate(lines) if line.startswith("tried"))
    assert lines[at].endswith(f"kp 0.3, i_tn 0.05 s, d_tv 0.001 s in {CONST_DIST}:")
    assert lines[at + 1].strip() == f"passes a step by {share} as predicted, within 1.2 um"


@pytest.mark.parametrize(
    ("given", "words"),
    [
        (FilterSettings(kind="MOVING_AVERAGE", n_cycles=7), "MOVING_AVERAGE, 7 values"),
        (FilterSettings(kind="LOWPASS", low_pass_filter_order=2, low_pass_filter_fg_f0=12.5),
         "LOWPASS, order 2, 12.5 Hz"),
    ],
)  # fmt: skip
def test_a_filter_has_the_parameters_that_act_on_it(given: Any, words: str) -> None:
    configured = replace_filter(tuned(), given)
    assert data_of(configured)["filter"] == words
    assert f"filter        {words}" in text_of(configured).splitlines()


def replace_filter(made: Tuning, given: Any) -> Tuning:
    configured: Any = SimpleNamespace(**{**vars(made.configured), "filter": given})
    return replace(made, configured=configured)


# The picture


def axes() -> Any:
    return Figure().add_subplot()


def test_an_answer_holds_its_value_from_its_cycle_to_the_next_one() -> None:
    """0.25 more at each of 4, 8, 12 and 16 ms, and not before."""
    drawn = axes()
    _path(drawn, tuned(actual=Path(np.array([1.0]), 0.0, 0.0)))
    distance, motor = drawn.get_lines()
    assert [line.get_drawstyle() for line in (distance, motor)] == ["steps-post"] * 2
    assert [line.get_linestyle() for line in (distance, motor)] == ["-", "--"]
    assert [line.get_label() for line in (distance, motor)] == ["distance", "motor"]
    assert distance.get_xdata()[:5] == pytest.approx([0.0, 4.0, 8.0, 12.0, 16.0])
    assert distance.get_ydata()[:5] == pytest.approx([0.0, 0.25, 0.5, 0.75, 1.0])
    assert motor.get_ydata() == pytest.approx(1.0)
    assert drawn.get_xlabel() == "ms since the cycle that computed it"


def test_the_closed_loop_is_drawn_in_ms_and_within_its_window() -> None:
    ran = np.linspace(0.0, 1.0, 40)
    drawn = axes()
    _steps(drawn, tuned(trial=Trial(Law(0.3), ran, ran * 0.5, 0.0), period_s=2e-3))
    run, predicted, configured = drawn.get_lines()
    for line in (run, predicted, configured):
        assert line.get_xdata()[:3] == pytest.approx([0.0, 2.0, 4.0])
    assert (run.get_linestyle(), run.get_marker()) == ("None", ".")
    assert (predicted.get_linestyle(), configured.get_linestyle()) == ("-", ":")
    assert drawn.get_ylim() == (-0.5, 2.0)
    assert [text.get_text() for text in drawn.get_legend().get_texts()] == [
        "kp 0.3, run", "predicted", "as configured",
    ]  # fmt: skip


def test_the_open_loop_of_the_chosen_mode_ends_at_half_the_cycles_a_second() -> None:
    """4 ms: 125 Hz; the mode is the one that the list chooses."""
    both = mode(BOTH_ENCODERS, 1.0, advice=replace(ADVICE, law=Law(0.05)))
    made = tuned(modes=(mode(CONST_DIST, 1.0), both, mode(SET_POS, 2.0)))
    made.configured.uses_both = True
    gain, phase = axes(), axes()
    _bode(gain, phase, made)
    labels = [line.get_label() for line in gain.get_lines()]
    assert labels[:2] == ["as configured, kp 0.2", "suggested, kp 0.05"]
    for drawn in (gain, phase):
        assert drawn.get_lines()[0].get_xdata()[-1] == pytest.approx(125.0)
        assert drawn.get_xscale() == "log"
    assert (gain.get_yscale(), phase.get_yscale()) == ("log", "linear")
    assert phase.get_ylim() == (-450.0, 0.0)


@pytest.mark.parametrize(
    ("law", "is_shown"),
    [
        (Law(0.2), True),
        (Law(0.2, tv_s=0.002), False),
        (Law(0.2, tn_s=0.1), False),
        (Law(0.2, 0.1, 0.002), False),
    ],
)
def test_a_closed_form_is_that_of_a_law_without_i_and_d_part(law: Law, is_shown: bool) -> None:
    known = replace(mode(CONST_DIST, 1.0), closed_limit=0.98)
    assert ("; closed form 0.98" in text_of(found(law, modes=(known,)))) is is_shown
    unknown = replace(known, closed_limit=None)
    assert "closed form" not in text_of(found(law, modes=(unknown,)))
