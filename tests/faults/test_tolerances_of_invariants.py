"""Tolerances of invariants, what faults hide, and what is counted; recordings by hand."""

from collections.abc import Sequence

import pytest
from tests.faults.made_runs import LISTS, STEP_MM, found, left, ramp
from tests.faults.test_invariants_of_offsets import blind, offset
from tests.faults.test_unknowable_values import AT_EDGE, TRUE_MM, touched

from axisrig.bench.tools.scenarios.campaign import Tally
from axisrig.bench.tools.scenarios.oracle import Judgement, Result, judge
from axisrig.bench.tools.scenarios.scenario import Scenario, drawn_kinds
from axisrig.kernel.time.clock import MS

# Values


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize(
    ("increments", "result"), [(0.9, Result.GOOD), (1.1, Result.BROKEN), (50.0, Result.BROKEN)]
)
def test_a_value_at_the_plc_is_true_to_an_increment(
    increments: float, result: Result, sign: int
) -> None:
    assert judge(touched(TRUE_MM[AT_EDGE] + sign * increments * STEP_MM)).result is result


# Limits of several controls


OWN = {**LISTS, "kenngr.dist_ctrl[0].v_max": 50_000, "kenngr.dist_ctrl[0].a_max": 1000}


@pytest.mark.parametrize(
    ("own", "whole", "allowed_mm_s"),
    [(False, False, 100.0), (True, False, 150.0), (False, True, 120.0), (True, True, 170.0)],
)
@pytest.mark.parametrize("sign", [1, -1])
def test_each_control_that_superposes_has_its_speed_on_top_of_the_axis(
    own: bool, whole: bool, allowed_mm_s: float, sign: int
) -> None:
    """100 mm/s of the axis, 50 of its own control, 20 of 3D control; an increment of rounding."""
    for more_mm_s, wrong in ((-0.1, []), (STEP_MM * 1e3 + 0.1, ["speed"])):
        step_mm = sign * (allowed_mm_s + more_mm_s) * 1e-3
        made = left(
            "distance", [step_mm * row for row in range(100)], OWN if own else LISTS,
            control=("INACTIVE", "ACTIVE") if own else (),
            channel_lists={"v_max": 20_000} if whole else None,
        )  # fmt: skip
        assert found(made) == wrong


@pytest.mark.parametrize(
    ("own", "whole", "allowed_mm_s2"),
    [(False, False, 4000.0), (True, False, 5000.0), (False, True, 4300.0), (True, True, 5300.0)],
)
def test_each_control_that_superposes_has_its_acceleration_on_top_of_the_axis(
    own: bool, whole: bool, allowed_mm_s2: float
) -> None:
    """Two increments of rounding: 20 mm/s2."""
    for more, wrong in ((-5.0, []), (30.0, ["acceleration"])):
        made = left(
            "distance", ramp(60.0, allowed_mm_s2 + more), OWN if own else LISTS,
            control=("INACTIVE", "ACTIVE") if own else (),
            channel_lists={"a_max": 300} if whole else None,
        )  # fmt: skip
        assert found(made) == wrong


@pytest.mark.parametrize(
    ("steps_um", "wrong"),
    [([1.9], []), ([2.1], ["blind"]), ([1.0, 0.9], []), ([1.0, 1.1], ["blind"]), ([-50.0], [])],
)
def test_a_blind_offset_at_rest_has_what_two_cycles_of_its_acceleration_make(
    steps_um: Sequence[float], wrong: list[str]
) -> None:
    """2 a T^2: 1000 mm/s2 for a cycle that is computed and one that is sent, of 1 ms: 2 um."""
    way_mm = [-1e-3 * sum(steps_um[: max(row - 50, 0)]) for row in range(100)]
    made = offset(way_mm, blind(45, 99))
    assert [name for name in found(made) if name == "blind"] == wrong


@pytest.mark.parametrize(("way_um", "wrong"), [(24.4, []), (24.6, ["blind"])])
def test_a_blind_offset_goes_on_for_what_its_braking_and_two_cycles_take(
    way_um: float, wrong: list[str]
) -> None:
    """5 mm/s and 1000 mm/s2: v^2/2a 12.5 um, 2 v T 10 um, 2 a T^2 2 um."""
    course_mm = [-5e-3 * min(row, 49) for row in range(50)]
    course_mm += [course_mm[49] - way_um * 1e-3 * min(n / 8.0, 1.0) for n in range(1, 51)]
    made = offset(course_mm, blind(50, 99))
    assert [name for name in found(made) if name == "blind"] == wrong


@pytest.mark.parametrize("end_ms", [100, 60, 20])
def test_set_positions_are_looked_at_until_the_recording_ends(end_ms: int) -> None:
    """110 mm/s in one row, 100 allowed, also after the program has come to its end."""
    places = [0.11 * (row >= 70) for row in range(100)]
    lists = {name: each for name, each in LISTS.items() if name.endswith("vb_max")}
    assert found(left(set_mm=places, lists=lists, end_ns=end_ms * MS)) == ["speed"]
    assert found(left(set_mm=[0.9 * mm for mm in places], lists=lists, end_ns=end_ms * MS)) == []


# What faults hide


HIDING = {name: kind.hides for name, kind in drawn_kinds().items() if kind.hides}


@pytest.mark.parametrize("name", HIDING)
@pytest.mark.parametrize("is_first", [True, False])
def test_a_fault_hides_what_it_hides_beside_whatever_other_one(name: str, is_first: bool) -> None:
    faults = [f"fault:{name}=a", "fault:drop=can1.TPDO1 p=0.1"]
    assert not drawn_kinds()["drop"].hides
    given = ("plc:V.E.A=1", *(faults if is_first else faults[::-1]))
    assert Scenario(0, 0, given).hidden == frozenset(HIDING[name])


def test_what_is_no_fault_and_what_nobody_draws_hides_nothing() -> None:
    kind = next(iter(HIDING))
    assert Scenario(0, 0, (f"plant:{kind}=1", "fault:drop=a")).hidden == frozenset()
    assert Scenario(0, 0, ("fault:image_lost_by_hand=a",)).hidden == frozenset()


def test_faults_of_a_scenario_are_its_columns_of_faults_alone() -> None:
    given = ("plc:V.E.A=1", "fault:drop=a; b", "plant:z.kv=40", "fault:reset=Z")
    assert Scenario(0, 0, given).faults == ("fault:drop=a; b", "fault:reset=Z")


# Counts


@pytest.mark.parametrize(("kind", "is_open"), [("drop", False), *((name, True) for name in HIDING)])
def test_values_that_nobody_can_know_are_those_whose_invariant_is_hidden(
    kind: str, is_open: bool
) -> None:
    hides_value = is_open and "value" in HIDING[kind]
    tally = Tally()
    tally.add(Scenario(1, 0, (f"fault:{kind}=a",)), Judgement(Result.GOOD, right=2))
    (name,) = tally.counts
    assert name.endswith("others nobody can know" if hides_value else "all right")


def test_every_fault_of_a_scenario_is_counted_with_its_kind() -> None:
    given = ("plc:V.E.A=1", "fault:drop=a; b", "fault:reset=Z", "fault:delay=a")
    tally = Tally()
    for number in range(2):
        tally.add(Scenario(number, 0, given), Judgement(Result.NO_TRUTH))
    assert tally.kinds == {"fault:drop": 2, "fault:reset": 2, "fault:delay": 2}


def test_a_table_counts_each_kind_that_was_brought_in_their_order() -> None:
    kinds = sorted(drawn_kinds(), reverse=True)
    tally = Tally()
    for number, kind in enumerate(kinds):
        for _ in range(number + 1):
            tally.add(Scenario(number, 0, (f"fault:{kind}=a",)), Judgement(Result.NO_TRUTH))
    lines = tally.table().splitlines()
    counted = lines[lines.index("faults of each kind") + 1 :]
    assert counted == [
        f"  {len(kinds) - number:>6}  fault:{kind}" for number, kind in enumerate(kinds[::-1])
    ]
