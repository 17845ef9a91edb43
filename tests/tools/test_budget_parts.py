"""Parts of a budget alone: games of causes, what is left of a value, runs of a row, motion columns.

The error of a game is a function of the causes that are on, and only of runs that were made before.
"""

from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.campaign.results.writer import CaseResult
from axisrig.bench.plan.assignment import parse_assignment
from axisrig.bench.plan.case import Case
from axisrig.bench.plan.checks import judge
from axisrig.bench.plan.plan import read_plan
from axisrig.bench.plan.select import only
from axisrig.bench.plan.verdict import Verdict
from axisrig.bench.rig.contents import settings_of
from axisrig.bench.tools.budget.budget import (
    CYCLES,
    Budget,
    Share,
    _of_cycles,
    _of_rounding,
    _quantum_um,
    _Runs,
    _with_motion,
)
from axisrig.bench.tools.budget.causes import Active, causes, measuring_axis, motion_causes
from axisrig.bench.tools.budget.combining import Runs, combined, groups
from axisrig.bench.tools.budget.motion import (
    AT_ONCE,
    braking_words,
    run_up_words,
    without_braking,
    without_run_up,
)
from axisrig.bench.tools.budget.observed_run import METRICS, Seen, Track
from axisrig.kernel.errors import UserError
from axisrig.kernel.time.clock import MS

PLANS = Path(__file__).parents[2] / "testplans"


class Game:
    """Runs of so many causes; `made`: all that were asked for, each as what is off."""

    def __init__(
        self, count: int, error_um: Callable[[set[int]], float], apart: Iterable[int] = ()
    ) -> None:
        self.made: set[frozenset[int]] = set()
        self._error_um, self._all = error_um, set(range(count))
        self.runs = Runs(count, self._make, self._of, frozenset(apart))

    def _make(self, offs: Iterable[frozenset[int]]) -> None:
        self.made.update(offs)

    def _of(self, off: Iterable[int]) -> float:
        assert frozenset(off) in self.made, "not made before"
        return self._error_um(self._all - set(off))


def test_a_cause_that_is_apart_is_off_throughout_and_in_no_group() -> None:
    game = Game(4, lambda on: 100.0 * (1 in on) + 3.0 * ({0, 2} <= on) + 2.0 * (3 in on), [1])
    assert groups(game.runs, 1e-6) == [[0, 2], [3]]
    found = combined(game.runs, 1e-6)
    assert found.shares_um == pytest.approx({0: 1.5, 2: 1.5, 3: 2.0})
    assert (found.interacting, found.left_out) == ({0, 2}, frozenset())
    assert all(1 in off for off in game.made)


@pytest.mark.parametrize(("tolerance_um", "parts"), [(0.5, [[0], [1]]), (0.4999, [[0, 1]])])
def test_causes_that_act_on_each_other_by_the_tolerance_do_not(
    tolerance_um: float, parts: list[list[int]]
) -> None:
    game = Game(2, lambda on: 1.0 * (0 in on) - 0.5 * (len(on) == 2))
    assert groups(game.runs, tolerance_um) == parts


def test_what_needs_three_is_shared_by_three() -> None:
    """e = 6 where all three are on, and 1 of the first alone: 3, 2 and 2."""
    game = Game(3, lambda on: 6.0 * (len(on) == 3) + 1.0 * (0 in on))
    found = combined(game.runs, 1e-6)
    assert found.shares_um == pytest.approx({0: 3.0, 1: 2.0, 2: 2.0})
    assert found.interacting == {0, 1, 2}


def test_a_cause_in_the_midst_of_others_need_not_depend_on_them() -> None:
    """1 is between 0 and 2, which multiply: its share is the same whatever is on."""
    game = Game(3, lambda on: 4.0 * ({0, 2} <= on) - 7.0 * (1 in on))
    assert groups(game.runs, 1e-6) == [[0, 1, 2]]
    found = combined(game.runs, 1e-6)
    assert found.shares_um == pytest.approx({0: 2.0, 1: -7.0, 2: 2.0})
    assert found.interacting == {0, 2}


@pytest.mark.parametrize(
    ("most", "left_out"),
    [(64, set()), (12, set()), (11, {4}), (8, {4}), (7, {2, 3, 4}), (4, {2, 3, 4}),
     (3, {0, 1, 2, 3, 4})],
)  # fmt: skip
def test_the_smallest_group_is_combined_first(most: int, left_out: set[int]) -> None:
    """4 runs for 0 and 1; 8 for 2, 3 and 4, or 4 for the two that depend most on each other."""
    game = Game(5, lambda on: 5.0 * ({0, 1} <= on) + 9.0 * ({2, 3} <= on) + 1.0 * ({3, 4} <= on))
    found = combined(game.runs, 1e-6, most)
    assert found.left_out == left_out
    assert sum(found.shares_um.values()) == pytest.approx(15.0)
    if 0 in left_out:
        assert found.shares_um == pytest.approx({0: 0.0, 1: 5.0, 2: 0.0, 3: 9.0, 4: 1.0})
    elif left_out == {4}:
        assert found.shares_um == pytest.approx({0: 2.5, 1: 2.5, 2: 4.5, 3: 4.5, 4: 1.0})


def test_a_large_group_before_a_small_one_takes_no_runs_from_it() -> None:
    """4 runs for 3 and 4, 8 for 0, 1 and 2: of 8 there is room for two of these."""

    def error_um(on: set[int]) -> float:
        return 5.0 * ({3, 4} <= on) + 9.0 * ({0, 1} <= on) + 1.0 * ({1, 2} <= on)

    for most, left_out in ((12, set()), (11, {2}), (8, {2}), (7, {0, 1, 2}), (4, {0, 1, 2})):
        found = combined(Game(5, error_um).runs, 1e-6, most)
        assert found.left_out == left_out, most
        assert {place: found.shares_um[place] for place in (3, 4)} == {3: 2.5, 4: 2.5}
        assert sum(found.shares_um.values()) == pytest.approx(15.0)


def test_who_depends_least_by_first_last_and_in_turn_is_left_out() -> None:
    """The share of 1 is 8 alone, 0 beside all others and 8 in turn; of the others by 1 or 2."""

    def error_um(on: set[int]) -> float:
        return 8.0 * (1 in on) * (2 not in on) + 2.0 * ({0, 2} <= on) + 1.0 * ({1, 3} <= on)

    found = combined(Game(4, error_um).runs, 1e-6, 4)
    assert found.left_out == {0, 3}
    assert sum(found.shares_um.values()) == pytest.approx(error_um({0, 1, 2, 3}))


# --- what is left


def share(um: float, place: str = "drive", **more: Any) -> Share:
    cause = CYCLES if place == "cycles" else next(c for c in causes() if c.place == place)
    return Share(cause, "", um, um, None, None, **more)


def budget(left_um: float, *shares: Share, increment_um: float = 0.1, quantum: float = 0) -> Budget:
    return Budget("run", "Z", 1.0, -10.0, increment_um, left_um, shares, "", quantum)


@pytest.mark.parametrize(
    ("shares", "largest"),
    [
        ((), None),
        ((share(0.1),), None),
        ((share(-0.1001), share(0.05)), 0),
        ((share(0.5), share(-2.0), share(1.0)), 1),
        ((share(9.0, "cycles"), share(0.5)), 1),
        ((share(9.0, "cycles"),), None),
    ],
)
def test_the_largest_cause_is_above_an_increment_and_no_cycle(
    shares: tuple[Share, ...], largest: int | None
) -> None:
    found = budget(0.0, *shares).largest
    assert found is (None if largest is None else shares[largest])


def test_what_is_left_is_explained_up_to_what_a_value_resolves() -> None:
    for left_um, quantum, is_explained in (
        (0.1, 0.0, True), (-0.1001, 0.0, False), (-5.0, 5.0, True), (5.001, 5.0, False),
    ):  # fmt: skip
        assert budget(left_um, quantum=quantum).is_explained is is_explained
    assert budget(0.0, share(1.0, interacts=True), share(2.0)).interacting == (
        share(1.0, interacts=True),
    )


SETTINGS: Any = SimpleNamespace(
    rig=SimpleNamespace(
        cycle=SimpleNamespace(period_us=1000, cycle_offset_us=600),
        plc_task=SimpleNamespace(period_us=4000),
    )
)


def seen(**given: Any) -> Seen:
    values = {"error_um": -30.0, "velocity_mm_s": -10.0, "latch_ms": None, "source_um": None,
              "track": None}  # fmt: skip
    return Seen(**(values | given))


def test_a_value_of_unknown_instant_resolves_the_way_of_both_cycles() -> None:
    """10 mm/s in 1 ms and 4 ms: 50 um."""
    assert _quantum_um(SETTINGS, seen(), 0.1) == pytest.approx(50.0)
    assert _quantum_um(SETTINGS, seen(latch_ms=0.5), 0.1) == 0.1
    assert _quantum_um(SETTINGS, seen(value_ms=3.0), 0.1) == 0.1
    assert _quantum_um(SETTINGS, seen(source_um=1.0), 0.1) == 0.1
    without: Any = SimpleNamespace(rig=SimpleNamespace(cycle=SETTINGS.rig.cycle, plc_task=None))
    assert _quantum_um(without, seen(), 0.1) == 0.1


def test_the_way_of_the_cycles_is_shared_out() -> None:
    """A value 5 ms after the contact at -10 mm/s: -50 um, of it -20 um until the sample at 2 ms."""

    def shares(**given: Any) -> list[tuple[str, float]]:
        found = _of_cycles(SETTINGS, seen(value_ms=5.0, **given), False)
        assert all(each.alone_um == each.in_turn_um for each in found)
        return [(each.cause.cause, pytest.approx(each.in_turn_um)) for each in found]

    assert shares() == [("CNC cycle", -50.0)]
    assert shares(sampled_ms=2.0) == [("digital input", -20.0), ("CNC cycle", -30.0)]
    assert shares(between_um=0.5) == [("position history", -49.5)]
    assert shares(sampled_ms=2.0, between_um=0.5) == [
        ("digital input", -20.0), ("position history", -29.5),
    ]  # fmt: skip
    combined_um = [each.combined_um for each in _of_cycles(SETTINGS, seen(value_ms=5.0), True)]
    assert combined_um == [pytest.approx(-50.0)]


@pytest.mark.parametrize("between_um", [0.5, -0.5])
def test_what_the_cycles_cost_has_its_setting_and_a_mean_where_causes_are_combined(
    between_um: float,
) -> None:
    """A cubic between SYNCs may be off either way; where nothing was combined there is no mean."""
    rig: Any = SimpleNamespace(
        rig=SimpleNamespace(cycle=SimpleNamespace(period_us=2000, cycle_offset_us=300))
    )
    for given, settings in (
        ({}, ["period 2000 us, SYNC 300 us before the cycle"]),
        ({"between_um": between_um}, ["positions every 2000 us"]),
        (
            {"between_um": between_um, "sampled_ms": 2.0},
            ["SYNC every 2000 us", "positions every 2000 us"],
        ),
    ):
        for is_combined in (False, True):
            found = _of_cycles(rig, seen(value_ms=5.0, **given), is_combined)
            assert [each.setting for each in found] == settings
            for each in found:
                assert each.combined_um == (each.in_turn_um if is_combined else None)
                assert (each.expected_um, each.bound_um) == (None, None)


@pytest.mark.parametrize(("error_um", "left_um"), [(-5.3, -0.3), (-4.6, 0.4), (0.0, 5.0)])
def test_the_rounding_is_what_a_latch_has_beside_the_way_until_it(
    error_um: float, left_um: float
) -> None:
    """-10 mm/s for 0.5 ms are -5 um; a whole increment of 2.5 um is the bound."""
    left = seen(error_um=error_um, latch_ms=0.5)
    for is_combined in (False, True):
        found = _of_rounding(left, 2.5, is_combined)
        assert found.cause.cause == "encoder"
        assert (found.alone_um, found.in_turn_um) == (pytest.approx(left_um),) * 2
        assert found.bound_um == 2.5
        assert found.combined_um == (pytest.approx(left_um) if is_combined else None)
        assert found.setting == "increments of 2.5 um"


def test_braking_is_a_cause_of_each_motion_and_the_run_up_where_speed_is_gained() -> None:
    """A value after the signal is of a stop that hardly begins, at the speed of the contact."""
    settings = settings_of(PLANS / "rigs" / "probe-z.toml", [])
    for is_after in (False, True):
        for speed_mm_s in (None, -40.0):
            only, both = (
                motion_causes(
                    settings,
                    "Z",
                    is_after_signal=is_after,
                    gains_speed=gains,
                    speed_mm_s=speed_mm_s,
                )
                for gains in (False, True)
            )
            assert [each.cause.cause for each in only] == ["braking"]
            assert [each.cause.cause for each in both] == ["run-up", "braking"]
            assert both[0].off == without_run_up(settings)
            assert both[0].setting == run_up_words(settings, "Z")
            assert only[0].setting == braking_words(settings, "Z") != both[0].setting
            assert both[1] == only[0]
            stop = only[0].off["set:Z.getriebe[0].lslope_profil.a_feedh"]
            # 0.5 s from the speed of the contact, either sign; else 1 mm/s2, or at once
            hardly = "80" if speed_mm_s else "1"
            assert stop == (hardly if is_after else "10000000")


def test_the_way_in_a_ramp_is_that_of_the_truth() -> None:
    """x = 100 - 10 t + 1000 t^2 (mm, s), known each ms; the contact is at 2 ms."""
    times = [k * MS for k in range(8)]
    track = Track(
        times,
        [100 - 10 * t * 1e-9 + 1000 * (t * 1e-9) ** 2 for t in times],
        [-10 + 2000 * t * 1e-9 for t in times],
        2 * MS, 1, 0.25,
    )  # fmt: skip
    at = seen(track=track)

    def way_um(begin_ms: float, end_ms: float) -> float:
        first, last = ((2 + ms) * 1e-3 for ms in (begin_ms, end_ms))
        return ((last**2 - first**2) * 1000 - 10 * (last - first)) * 1e3

    for begin_ms, end_ms in ((0.0, 0.25), (0.5, 3.75), (1.0, 0.0), (-2.0, 5.0)):
        assert at.moved_um(begin_ms, end_ms) == pytest.approx(way_um(begin_ms, end_ms))
    assert seen().moved_um(1.0, 3.0) == pytest.approx(-20.0)
    late = seen(track=track, latch_ms=0.5)
    assert late.delayed_um == pytest.approx(way_um(0, 0.5))
    assert late.way_um is None
    assert seen(source_um=4.0).way_um == pytest.approx(-34.0)
    of_source = seen(value_ms=2.0, between_um=0.5, lost_um=0.25)
    assert of_source.way_um == of_source.delayed_um == pytest.approx(-20 + 0.75)


# --- runs of a row


def row(*texts: str) -> Case:
    plan = read_plan(PLANS / "latch_accuracy.csv")
    return only(plan.with_inputs([parse_assignment(text) for text in texts]).cases, "f600")


class Ran:
    """Gives results in the other order, with a hash of frames of their own; refuses some."""

    def __init__(self, refused: str | None = None) -> None:
        self.names: list[str] = []
        self._refused = refused

    def __call__(self, cases: Sequence[Case]) -> Iterator[CaseResult]:
        self.names += [case.run for case in cases]
        for case in reversed(cases):
            there = dict(zip(METRICS, (1.0, -10.0, 0.5, None), strict=True))
            if self._refused is not None and case.inputs.get(self._refused) == "1":
                there["latch_error_um"] = None
            checks = [judge(check, there[check.name]) for check in case.checks]
            facts: Any = SimpleNamespace(frame_log_sha256=f"of {case.run}")
            yield CaseResult(case, Verdict.PASS, checks, facts=facts)


def active(cause: str, **off: str) -> Active:
    found = next(each for each in causes() if each.cause == cause)
    return Active(found, "1", "", {name.replace("__", ":"): value for name, value in off.items()})


def test_runs_have_numbers_and_the_frames_are_of_the_one_with_all_causes() -> None:
    ran = Ran()
    runs = _Runs(row(), "Z", ran)
    runs.active = [active("pre-travel", **{"plant:probe.pretravel_um": "0"})] * 2
    runs.make([frozenset()])
    runs.make([frozenset([1]), frozenset(), frozenset([0, 1]), frozenset([1])])
    whole = row().run
    assert ran.names == [f"{whole}-budget-{number:03d}" for number in (0, 1, 2)]
    assert runs.frames == f"of {ran.names[0]}"
    runs.forget()
    assert runs.error_um(()) == 1.0
    assert len(ran.names) == 3
    assert runs.error_um([1]) == 1.0
    assert ran.names[3:] == [f"{whole}-budget-003"]


def test_a_motion_without_which_there_is_no_value_is_kept_on() -> None:
    """Its place is taken by the cause after it."""
    run_up, braking = (each for each in causes() if each.place == "motion")
    first = active("pre-travel", **{"plant:probe.pretravel_um": "0"})
    found = [first, Active(run_up, "", "", {"plant:probe.trigger_delay_us": "1"}),
             Active(braking, "", "", {"plant:probe.trigger_delay_us": "2"})]  # fmt: skip
    runs = _Runs(row(), "Z", Ran("plant:probe.trigger_delay_us"))
    kept, names = _with_motion(runs, found)
    assert [each.cause.cause for each in kept] == [first.cause.cause, braking.cause]
    assert names == (run_up.cause,)
    assert _with_motion(_Runs(row(), "Z", Ran()), found) == (found, ())


def test_an_axis_that_has_to_be_named_is_hinted_at() -> None:
    one = settings_of(PLANS / "rigs" / "probe-z.toml", [])
    assert measuring_axis(one, None) == measuring_axis(one, "Z") == "Z"
    with pytest.raises(UserError, match="which axis") as error:
        measuring_axis(one, "X")
    assert (error.value.allowed, error.value.hint) == ("Z", "--axis Z")
    none = settings_of(PLANS / "rigs" / "distance-z.toml", [])
    with pytest.raises(UserError, match="no axis of the rig has a probe") as error:
        measuring_axis(none, None)
    assert error.value.hint is None


# --- motion

LINEAR, JERK = "getriebe[0].lslope_profil", "getriebe[0].slope_profil"


@pytest.mark.parametrize(
    ("given", "stop"),
    [
        ({"is_after_signal": False}, 10_000_000),
        ({"is_after_signal": False, "speed_mm_s": 50.0}, 10_000_000),
        ({"is_after_signal": True}, 1),
        ({"is_after_signal": True, "speed_mm_s": -50.0}, 100),  # in half a second
        ({"is_after_signal": True, "speed_mm_s": 0.1}, 1),
    ],
)
@pytest.mark.parametrize(("use_std", "key"), [(0, "grenz_stufe"), (1, "stufe")])
def test_columns_that_take_braking_away(
    given: dict[str, Any], stop: int, use_std: int, key: str
) -> None:
    """FCT-C4 2.1: rapid or feed values brake, as P-CHAN-00296 says; the feedhold stops."""
    settings = settings_of(
        PLANS / "rigs" / "probe-z.toml", [f"set:channel.meas_use_std_dynamic={use_std}"]
    )
    assert without_braking(settings, **given) == {
        "set:channel.use_drive_curr_limit": "1",
        "set:channel.meas_deceleration_mode": "0",
        f"set:Z.{LINEAR}.d_{key}_1": "10000000",
        f"set:Z.{LINEAR}.d_{key}_2": "10000000",
        f"set:Z.{LINEAR}.a_feedh": str(stop),
        f"set:Z.{JERK}.a_feedh": str(stop),
        f"set:Z.{JERK}.tr_feedh": "1",
    }
    values = settings.axis["Z"]
    brakes = values.mm_s2(f"{LINEAR}.d_{key}_1")
    assert braking_words(settings, "Z") == f"d_{key}_1 {brakes:g} mm/s2"
    gains = values.mm_s2(f"{LINEAR}.a_{key}_1")
    assert run_up_words(settings, "Z") == f"a_{key}_1 {gains:g} mm/s2"
    columns = without_run_up(settings)
    assert {name for name, value in columns.items() if value == str(AT_ONCE)} == {
        f"set:Z.{LINEAR}.a_{key}_{step}" for step in (1, 2)
    }
    assert columns[f"set:Z.{LINEAR}.d_{key}_1"] == f"{brakes:.0f}"
    assert columns[f"set:Z.{LINEAR}.a_feedh"] == f"{values.mm_s2(f'{LINEAR}.a_feedh'):.0f}"
    assert len(columns) == 5
