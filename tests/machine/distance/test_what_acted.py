"""Metrics judge by what acted: words of the program and CNC objects, not the list alone.

The list of the shipped rig: kp 0.2, mean of 4, optimized scheduling off, so two dead cycles.
Closed forms: limit of a mean of N values in CONST_DIST, 2 N sin^2(w/2)/sin(N w/2) with w = pi/(N +
2n); both encoders n = 1 of Z_com; the error on a ramp v T/kp.
"""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from axisrig.bench.judge.distance.findings import control_findings
from axisrig.bench.judge.observed.observation import Observation
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.judge.topics import observe
from axisrig.bench.plan.checks import known_metrics, parse_check

ON = "Z[DIST_CTRL ON CONST_DIST SET_DIST=2{}]"
OFF = "Z[DIST_CTRL OFF NO_MOVE]"
CALM = ("set:Z.kenngr.distc.max_act_value_change=9000000",)
STEEP = (*CALM, "set:Z.kenngr.distc.v_max=500000", "set:Z.kenngr.distc.a_max=9000000")
STEP = ("plant:gap.lift_mm=0.05", "plant:gap.lift_begin_ms=40.2", "plant:gap.lift_end_ms=40.2")
RAMP = ("plant:gap.lift_mm=2", "plant:gap.lift_begin_ms=30", "plant:gap.lift_end_ms=2030")
OBJECT = "plc:Z.object.DIST_CTRL::"


class Judged:
    """A run and what metrics find of it."""

    def __init__(self, observed: Observed) -> None:
        self.observed = observed

    def of(self, metric: str) -> Observation:
        words = known_metrics()[metric].words
        condition = f"== {words.split()[0]}" if words else "!= 0"
        return observe(self.observed, parse_check(metric, condition, "here"))

    def value(self, metric: str) -> float:
        seen = self.of(metric)
        assert isinstance(seen.value, float | int), f"{metric}: {seen.note}"
        return float(seen.value)


Run = Callable[..., Judged]


@pytest.fixture
def run(run_nc: Callable[..., Any]) -> Run:
    def judged(blocks: str, *assignments: str, base: str = "distance-z.toml") -> Judged:
        lines = [f"N{10 * n} {word}" for n, word in enumerate(blocks.split("; "), 1)]
        return Judged(run_nc("\n".join(lines), "", *assignments, base=base).observed)

    return judged


def mean_limit(count: int, n: int) -> float:
    w = math.pi / (count + 2 * n)
    return 2 * count * math.sin(w / 2) ** 2 / math.sin(count * w / 2)


def growth_of_mean(kp: float, count: int, n: int) -> float:
    """Largest root of z^(n + N) (z - 1) + kp/N (z^N + ... + z)."""
    polynomial = np.zeros(n + count + 2)
    polynomial[:2] = 1.0, -1.0
    polynomial[1 + n : 1 + n + count] += kp / count
    return float(np.max(np.abs(np.roots(polynomial))))


# Limit and growth


@pytest.mark.parametrize(
    ("words", "objects", "kp", "count", "n"),
    [
        pytest.param(" N_CYCLES=20 KP=0.22", (), 0.22, 20, 2, id="mean and kp by the program"),
        pytest.param("", ("kp=0.35 at=5ms", "n_cycles=8 at=5ms"), 0.35, 8, 2, id="by objects"),
        pytest.param(
            " KP=0.3", ("kp=0.25 at=20ms",), 0.3, 4, 2, id="an object that nobody has adopted"
        ),
        pytest.param(" BOTH_ENCODER=1", (), 0.2, 4, 1, id="both encoders by the program"),
    ],
)
def test_limit_of_kp_and_growth_are_of_what_acts(
    run: Run, words: str, objects: tuple[str, ...], kp: float, count: int, n: int
) -> None:
    seen = run(
        f"G04 0.01; {ON.format(words)}; G04 0.03; {OFF}", *CALM, *(OBJECT + o for o in objects)
    )
    assert seen.value("distance_kp_limit") == pytest.approx(mean_limit(count, n), abs=1e-8)
    assert seen.value("distance_growth_expected") == pytest.approx(
        growth_of_mean(kp, count, n), abs=1e-6
    )


def test_both_encoders_of_the_list_that_the_program_takes_back(run: Run) -> None:
    listed = "set:Z.kenngr.distc.mode_dist_use_both_encoder=1"
    seen = run(f"{ON.format(' BOTH_ENCODER=0')}; G04 0.03; {OFF}", *CALM, listed)
    assert seen.value("distance_kp_limit") == pytest.approx(mean_limit(4, 2), abs=1e-8)


def test_integral_and_derivative_by_the_program(run: Run) -> None:
    """Roots of (1 - q)^2 + kp/N (1 - q + g + r (1 - q)^2) q^3 (1 + .. + q^3), g T/Tn, r Tv/T."""
    seen = run(f"{ON.format(' I_TN=0.05 D_TV=0.001')}; G04 0.03; {OFF}", *CALM)
    q: Any = np.polynomial.polynomial.Polynomial([0.0, 1.0])
    mean = q**3 * (1 + q + q**2 + q**3) / 4
    whole = (1 - q) ** 2 + 0.2 * ((1 - q) + 0.02 + 1.0 * (1 - q) ** 2) * mean
    growth = max(1 / abs(root) for root in whole.roots())
    assert seen.value("distance_growth_expected") == pytest.approx(growth, abs=1e-6)


def test_what_is_changed_while_on_is_judged_from_the_change_on(run: Run) -> None:
    seen = run(f"{ON.format('')}; G04 0.03; Z[DIST_CTRL N_CYCLES=10]; G04 0.03; {OFF}", *CALM)
    assert seen.value("distance_kp_limit") == pytest.approx(mean_limit(10, 2), abs=1e-8)
    assert seen.value("distance_filter_delay_expected_cycles") == pytest.approx(4.5)


@pytest.mark.long
def test_3d_control_by_words_of_the_program(run: Run) -> None:
    program = (
        "V.G.WZ_AKT.L=80; #TRAFO ON; #DIST CTRL [SENSOR_SOURCE=VARIABLE SENSOR_VAR=V.E.SENSOR];"
        " #DIST CTRL ON [CONST_DIST SET_DIST=80 MODE=MCS KP=0.15 FILTER_TIME=0.006]; G04 0.02"
    )
    limits = ("max_act_value_change=9000000", "optimized_scheduling=1", "max_pos=9000000")
    listed = [f"set:channel.dist_ctrl[0].{word}" for word in limits]
    seen = run(program, *listed, base="distance-5axis.toml")
    assert seen.value("distance_kp_limit") == pytest.approx(mean_limit(6, 1), abs=1e-6)
    assert seen.value("distance_growth_expected") == pytest.approx(
        growth_of_mean(0.15, 6, 1), abs=1e-6
    )


@pytest.mark.long
def test_3d_control_along_an_axis_over_a_tilted_workpiece(run: Run) -> None:
    """1 mm of Z is cos 30 deg of the distance: the limit of kp is divided by it."""
    program = (
        "V.G.WZ_AKT.L=80; #TRAFO ON; #DIST CTRL [SENSOR_SOURCE=VARIABLE SENSOR_VAR=V.E.SENSOR];"
        " #DIST CTRL ON [CONST_DIST SET_DIST=69.28 MODE=ACS DIRECTION=Z KP=0.2]; G04 0.02"
    )
    limits = ("max_act_value_change=9000000", "optimized_scheduling=1", "max_pos=9000000")
    listed = [f"set:channel.dist_ctrl[0].{word}" for word in limits]
    tilted = "plant:gap.workpiece_tilt_x_deg=30"
    seen = run(program, *listed, tilted, base="distance-5axis-orthogonal.toml")
    limit = mean_limit(4, 1) / math.cos(math.radians(30.0))
    assert seen.value("distance_kp_limit") == pytest.approx(limit, abs=1e-6)


# Errors


@pytest.mark.long
def test_the_error_on_a_ramp_is_of_the_kp_that_acts(run: Run) -> None:
    seen = run(
        f"{ON.format(' KP=0.1')}; G04 0.3; Z[DIST_CTRL KP=0.05]; G04 0.7; {OFF}", *STEEP, *RAMP
    )
    assert seen.value("distance_error_expected_um") == pytest.approx(1.0 / 0.05, rel=1e-6)
    assert seen.value("distance_error_um") == pytest.approx(20.0, abs=0.02)
    assert seen.value("distance_behind_um") == pytest.approx(20.0, abs=0.02)


@pytest.mark.long
def test_another_set_value_begins_the_steady_part_anew(run: Run) -> None:
    """400 cycles are there before it and 100 after it: the longer ones are judged."""
    course = "plc:Z.set_dist=2; 3 at=500ms"
    seen = run(f"{ON.format('')}; G04 0.6; {OFF}", *STEEP, course)
    assert seen.value("distance_error_um") == pytest.approx(0.0, abs=0.02)
    assert seen.of("distance_error_um").uncertainty <= 0.1


@pytest.mark.long
def test_a_mean_is_as_uncertain_as_the_error_swings(run: Run) -> None:
    """A limit cycle with kp far above its limit: its mean says nothing."""
    seen = run(f"{ON.format(' KP=1.9 N_CYCLES=1')}; G04 0.2; {OFF}", *STEEP, *STEP)
    for metric in ("distance_error_um", "distance_behind_um"):
        found = seen.of(metric)
        assert found.uncertainty > 50.0
        assert "swing" in found.note
    assert seen.of("distance_stability").value == "unstable"


def test_where_nothing_moved_there_is_no_stability(run: Run) -> None:
    seen = run(f"{ON.format(' KP=1.9 N_CYCLES=1')}; G04 0.05; {OFF}", *STEEP)
    for metric in ("distance_stability", "distance_growth"):
        found = seen.of(metric)
        assert found.value is None
        assert "nothing moved" in found.note


@pytest.mark.parametrize(
    ("words", "n"), [("", 2), pytest.param(" BOTH_ENCODER=1", 1, marks=pytest.mark.long)]
)
def test_growth_begins_where_the_program_has_moved_last(run: Run, words: str, n: int) -> None:
    """The distance sees each motion of the program, which says nothing of the loop."""
    moves = "G91 G01 Z0.3 F600; Z-0.2 F1200; Z0.1 F3000"
    seen = run(f"{ON.format(words)}; G04 0.02; {moves}; G04 0.1; {OFF}", *STEEP)
    assert seen.value("distance_growth") == pytest.approx(growth_of_mean(0.2, 4, n), abs=2e-3)
    assert seen.of("distance_stability").value == "stable"


@pytest.mark.long
def test_what_the_program_moves_all_the_time_shows_no_growth(run: Run) -> None:
    seen = run(f"{ON.format('')}; G91 G01 Z1 F600; {OFF}", *STEEP)
    assert "excites" in seen.of("distance_growth").note


def test_the_deviation_from_set_pos_does_not_see_the_program(run: Run) -> None:
    """The step of the surface at 40.2 ms is the last event."""
    moves = "G91 G01 Z0.3 F600; Z-0.3"
    seen = run(f"Z[DIST_CTRL ON SET_POS=30 KP=0.1]; G04 0.02; {moves}; {OFF}", *STEEP, *STEP)
    found = seen.of("distance_growth")
    assert found.value is not None, found.note


@pytest.mark.long
def test_no_overshoot_is_foretold_where_a_limit_was_changed_meanwhile(run: Run) -> None:
    one = run(f"{ON.format(' KP=0.1')}; G04 0.03; {OFF}", *CALM, *STEP)
    assert one.of("distance_overshoot_expected_mm").value is not None
    two = run(f"{ON.format('')}; G04 0.03; Z[DIST_CTRL KP=0.1]; G04 0.03; {OFF}", *CALM, *STEP)
    assert "changed" in two.of("distance_overshoot_expected_mm").note


# The own model


LEGAL = {
    "a dry run": (f"Z[DIST_CTRL DRYRUN CONST_DIST SET_DIST=2]; G04 0.08; {ON}; G04 0.05", ()),
    "a dry run of what is on": (
        f"{ON}; G04 0.02; Z[DIST_CTRL DRYRUN CONST_DIST]; G04 0.05; {ON}; G04 0.05", ()),
    "a dry run of the other mode": (
        f"Z[DIST_CTRL DRYRUN SET_POS=30]; G04 0.05; {ON}; G04 0.05", ()),
    "a dry run without set value": (f"Z[DIST_CTRL DRYRUN]; G04 0.05; {ON}; G04 0.05", ()),
    "SET_DIST while on": (f"{ON}; G04 0.03; Z[DIST_CTRL SET_DIST=2.1]; G04 0.05", ()),
    "SET_POS while on": (
        "Z[DIST_CTRL ON SET_POS=30]; G04 0.03; Z[DIST_CTRL SET_POS=30.1]; G04 0.05", ()),
    "SET_DIST of program and PLC side": (
        f"{ON}; G04 0.03; Z[DIST_CTRL SET_DIST=2.1]; G04 0.03; Z[DIST_CTRL SET_DIST=2.2]; G04 0.03",
        ("plc:Z.set_dist=2; 2.5 at=20ms over=60ms",)),
    "I_TN while on": (f"{ON}; G04 0.06; Z[DIST_CTRL I_TN=0.1]; G04 0.05", ()),
    "another I_TN while on": (
        f"Z[DIST_CTRL I_TN=0.05]; {ON}; G04 0.06; Z[DIST_CTRL I_TN=0.2]; G04 0.05;"
        " Z[DIST_CTRL I_TN=0]; G04 0.02; Z[DIST_CTRL I_TN=0.1]; G04 0.03", ()),
    "KP and D_TV while on": (f"{ON}; G04 0.05; Z[DIST_CTRL KP=0.1 D_TV=0.001]; G04 0.05", ()),
    "BOTH_ENCODER before": (f"Z[DIST_CTRL BOTH_ENCODER=1]; {ON}; G04 0.08", ()),
    "BOTH_ENCODER while on, twice": (
        f"{ON}; G04 0.045; Z[DIST_CTRL BOTH_ENCODER=1]; G04 0.03; Z[DIST_CTRL BOTH_ENCODER=0];"
        " G04 0.03", ()),
    "object v_max": (f"{ON}; G04 0.08", (f"{OBJECT}v_max=2000 at=4ms",)),
    "object a_max": (f"{ON}; G04 0.08", (f"{OBJECT}a_max=900 at=4ms",)),
    "objects adopted by a FREEZE": (
        f"{ON}; G04 0.03; Z[DIST_CTRL FREEZE]; G04 0.02; {ON}; G04 0.05",
        (f"{OBJECT}v_max=2000 at=10ms", f"{OBJECT}kp=0.1 at=10ms", f"{OBJECT}n_cycles=9 at=10ms")),
    "a filter and kp while frozen": (
        f"{ON}; G04 0.045; Z[DIST_CTRL FREEZE]; G04 0.01;"
        f" Z[DIST_CTRL FILTER_TYPE=EXPO_MEAN KP=0.1]; G04 0.01; {ON}; G04 0.05", ()),
    "ON again by the PLC side with objects": (
        f"{ON}; G04 0.12",
        ("plc:Z.dist_ctrl=FREEZE at=45ms; ON_CONST_DIST at=60ms", f"{OBJECT}kp=0.1 at=20ms")),
}  # fmt: skip
QUICK = ("a dry run of the other mode", "SET_DIST of program and PLC side", "another I_TN while on")


def _legal() -> list[Any]:
    return [
        pytest.param(*LEGAL[name], id=name, marks=() if name in QUICK else pytest.mark.long)
        for name in LEGAL
    ]


@pytest.mark.parametrize(("blocks", "plc"), _legal())
def test_every_legal_use_agrees_with_the_own_model(
    run: Run, blocks: str, plc: tuple[str, ...]
) -> None:
    seen = run(f"G04 0.01; {blocks.replace(ON, ON.format(''))}; {OFF}", *CALM, *STEP, *plc)
    assert not [alarm for alarm in seen.observed.facts.alarms if alarm.reaction_class > 1]
    assert seen.value("offset_model_error_um") <= 0.002


def test_the_model_sees_what_nobody_has_asked_for(run: Run) -> None:
    """An object that acts too early, or a word that does not act: the offset is another one."""
    seen = run(f"G04 0.01; {ON.format(' KP=0.1')}; G04 0.08; {OFF}", *CALM, *STEP)
    facts = seen.observed.facts
    record = facts.distance["Z"]
    assert record.orders is not None
    fewer = replace(record, orders=tuple(one for one in record.orders if not one.words))
    other = Observed(replace(facts, distance={"Z": fewer}), seen.observed.series)
    assert Judged(other).value("offset_model_error_um") > 1.0


def test_an_alarm_is_due_by_the_limit_that_acts(run: Run) -> None:
    """Step of 0.05 mm in a cycle: 50 mm/s, allowed by the list and not by the object."""
    seen = run(
        f"G04 0.01; {ON.format('')}; G04 0.06",
        *CALM,
        *STEP,
        f"{OBJECT}max_dist_change=40000 at=4ms",
    )
    assert [alarm.id for alarm in seen.observed.facts.alarms][:1] == [70329]
    assert seen.value("distance_alarm_late_cycles") == 0


# Recordings and report


@pytest.mark.long
def test_a_recording_without_orders_is_judged_by_its_changes(run: Run) -> None:
    seen = run(
        f"G04 0.01; Z[DIST_CTRL DRYRUN CONST_DIST SET_DIST=2]; G04 0.02; {ON.format(' KP=0.22')};"
        f" G04 0.03; Z[DIST_CTRL N_CYCLES=20 BOTH_ENCODER=1]; G04 0.05; {OFF}", *CALM, *STEP,
    )  # fmt: skip
    facts = seen.observed.facts
    older = replace(facts.distance["Z"], orders=None)
    of = Judged(Observed(replace(facts, distance={"Z": older}), seen.observed.series))
    for metric in ("distance_kp_limit", "distance_growth_expected", "offset_model_error_um"):
        assert of.value(metric) == pytest.approx(seen.value(metric), abs=1e-9)
    assert of.value("offset_model_error_um") <= 0.002


def test_set_values_of_the_plc_side_alone_are_in_the_series_only(run: Run) -> None:
    seen = run(
        f"{ON.format('')}; G04 0.05; {OFF}",
        *CALM,
        "plc:Z.set_dist=2 at=10ms; 2.2 at=20ms over=20ms",
    )
    orders = seen.observed.facts.distance["Z"].orders
    assert orders is not None
    assert [(one.by, one.action) for one in orders] == [
        ("NC", ""), ("NC", "ON_CONST_DIST"), ("NC", "OFF"),
    ]  # fmt: skip


def test_the_report_has_law_and_limits_that_acted(run: Run) -> None:
    seen = run(
        f"G04 0.01; {ON.format(' KP=0.1')}; G04 0.08; {OFF}", *CALM, *STEP,
        f"{OBJECT}v_max=1000 at=4ms",
    )  # fmt: skip
    (block,) = control_findings(seen.observed)
    (law,) = block.laws
    assert law.kp == 0.1
    assert law.growth == pytest.approx(growth_of_mean(0.1, 4, 2), abs=1e-6)
    v_max = next(row for row in block.limits if row.key == "v_max")
    assert v_max.value == 1.0
    assert v_max.used == pytest.approx(1.0)


def test_each_time_on_has_the_zero_of_its_own_reference(run: Run) -> None:
    """REF at two gaps: each time the tool is to be 0.5 mm farther away than there."""
    ref = "Z[DIST_CTRL REF]; Z[DIST_CTRL ON CONST_DIST SET_DIST=0.5]; G04 0.1"
    seen = run(
        f"G04 0.02; {ref}; {OFF}; G1 Z33 F6000; G04 0.05; {ref}; {OFF}", *STEEP,
        "plant:z.position_start_mm=32", "set:Z.kenngr.distc.max_pos=60000",
        "set:Z.kenngr.distc.min_pos=-95000",
    )  # fmt: skip
    assert not [alarm for alarm in seen.observed.facts.alarms if alarm.reaction_class > 1]
    assert abs(seen.value("distance_behind_end_um")) < 1.0
    assert seen.value("distance_behind_um_max") == pytest.approx(500.0, abs=1.0)
