"""Alarms, criteria, and what testplans/fixed_stop_timing.csv covers."""

import re

import pytest
from tests.plans.fixed_stop_law import Axis, axes, axis
from tests.plans.fixed_stop_setup import PLANS, band, is_rounded, most, rows

ROWS = rows()
ALARMS = {
    "== 900240": {
        "no-stop-lag",
        "no-stop-window",
        "no-stop-both",
        "nothing-detects",
        "window-without-time",
        "target-behind-stop",
        "target-in-stop",
    },
    "== 70082": {"drops", "canopen-example-weight", "ringing-short-window", "stop-pushes"},
    "contains 900005": {"drive-watches"},
    "== 110757 51026": {"per-mille-1001"},
    "== 110658 51026": {"per-mille-1001-older"},
    "== 900241": {"wrong-source"},
}
# Rows whose relaxing motion has a law closer than the exact-stop window
RELAXED = sorted(
    case
    for case, row in ROWS.items()
    if row["check:relax_lag_mm"]
    and ("restored" in row["tags"].split() or row["plant:z.feed_forward"] == "1")
)
# P-CHAN-00266: the row with 1 and the same with 0
NO_ERROR = {
    "no-stop-no-error": "no-stop-lag",
    "nothing-detects-no-error": "nothing-detects",
    "target-behind-stop-no-error": "target-behind-stop",
}


def _known(case: str) -> list[Axis]:
    return list(axes(ROWS[case]).values())


def test_alarms_and_nothing_else() -> None:
    answer = {name: row["check:alarms"] for name, row in ROWS.items()}
    expected = {name: text for text, names in ALARMS.items() for name in names}
    assert answer == {name: expected.get(name, "none") for name in ROWS}


@pytest.mark.parametrize("case", ROWS)
def test_merf_tells_whether_a_stop_was_found(case: str) -> None:
    row = ROWS[case]
    if row["check:alarms"] != "none" or "MERF" not in (PLANS / row["program"]).read_text("utf-8"):
        return
    columns = ("N70", "N80") if row["plc:V.E.X"] else ("N60",)
    value = "== 0" if case in NO_ERROR else "== 1"
    assert [row[f"check:msg:{column}"] for column in columns] == [value] * len(columns)
    if value == "== 0":
        assert row["check:detection_criterion"] == "== none"


def _foretold(found: Axis) -> bool:
    """Whether the criteria come true in free motion behind the arming."""
    limit, width = found.criteria.lag_mm, found.criteria.window_mm
    tau = found.criteria.tau_cycles * found.T
    by_lag = limit is None or limit < found.cnc_lag
    at_s = (width or 0) / (found.a * tau) + tau / 2 if tau else 0.0
    in_ramp = found.armed_from < found.a / 2 * at_s**2 and at_s < found.v / found.a
    at_start = found.armed_from == 0
    by_window = width is None or width >= found.v * tau or in_ramp or at_start
    return by_lag and by_window


@pytest.mark.parametrize("case", [name for name in ROWS if ROWS[name]["check:alarms"] == "none"])
def test_false_triggers_are_those_that_the_numbers_foretell(case: str) -> None:
    """Found without contact: criteria below the free motion, or a motor that cannot move it."""
    row, known = ROWS[case], _known(case)
    weak = [a for a in known if a.model == "GravityAxis" and not _can_move(a)]
    finds = [a for a in known if a.criteria.can_detect]
    is_false = bool(finds) and (bool(weak) or any(map(_foretold, finds)))
    assert is_false == ("false-trigger" in row["tags"].split())
    assert row["check:found_without_contact"] in (("== 1",) if is_false else ("== 0", ""))


def _can_move(found: Axis) -> bool:
    """Breakaway force and weight."""
    return found.limit_n - found.direction * found.weight_n > 160.0


def test_torque_limits_that_cannot_hold_or_move() -> None:
    """Friction holds what is between; below weight less breakaway force the axis drops."""
    for case in ("drops", "canopen-example-weight"):
        found = axis(ROWS[case])
        assert found.limit_n + 160.0 < found.weight_n + 1.0
    below = axis(ROWS["below-weight"])
    assert below.weight_n - 160.0 < below.limit_n < below.weight_n
    works = axis(ROWS["canopen-example"])
    moved = works.m_eff * works.a * 1e-3
    assert works.limit_n >= 1.5 * (works.friction_n + abs(works.weight_n) + moved)


def _decides(case: str) -> str:
    """The criterion that comes true last."""
    criteria = _known(case)[0].criteria
    if case in NO_ERROR:
        return "none"
    if criteria.lag_mm is None or criteria.window_mm is None:
        return "window" if criteria.lag_mm is None else "lag"
    found = axis(ROWS[case])
    by_lag = [at + found.criteria.tau_cycles * found.T for at in found.beyond]
    assert by_lag[0] > found.window[1] or found.window[0] > by_lag[1]
    return "lag" if by_lag[0] > found.window[1] else "window"


@pytest.mark.parametrize(
    "case", [name for name, row in ROWS.items() if row["check:detection_criterion"]]
)
def test_the_criterion_that_decides(case: str) -> None:
    assert ROWS[case]["check:detection_criterion"] == f"== {_decides(case)}"


@pytest.mark.parametrize(("behind", "is_found"), NO_ERROR.items())
def test_rows_without_alarm_are_the_others_with_p_chan_00266(behind: str, is_found: str) -> None:
    switch = "set:channel.meas_fixed_stop_no_error"
    assert (ROWS[behind][switch], ROWS[is_found][switch]) == ("1", "")
    same = {name for name in ROWS[behind] if name.startswith(("plc:", "plant:", "set:"))} - {switch}
    assert {ROWS[behind][name] for name in same} == {ROWS[is_found][name] for name in same}


def test_targets_that_leave_the_lag_below_its_limit() -> None:
    for case in ("target-behind-stop", "target-in-stop", "target-behind-stop-window"):
        found = axis(ROWS[case])
        left = found.block - found.stop - found.penetration[0]
        limit = found.criteria.lag_mm
        assert limit is None or left < limit
        assert (abs(left) < found.window_mm) == (case == "target-in-stop")


def test_drive_faults_before_the_cnc_has_found_the_stop() -> None:
    """8611 when the lag exceeds 6065, 10 mm, with 6066 = 0."""
    found = axis(ROWS["drive-watches"])
    sdo = dict(found.rig["drive"]["servo"]["sdo"])
    window_mm = sdo["0x6065:0"] * found.increment
    assert sdo["0x6066:0"] == 0
    assert found.criteria.lag_mm is not None
    assert found.lag < window_mm < found.criteria.lag_mm
    program = (PLANS / ROWS["drive-watches"]["program"]).read_text(encoding="utf-8")
    assert "MON_WINDOW" not in re.sub(r";.*", "", program)


@pytest.mark.parametrize("case", ROWS)
def test_limits_that_are_the_same_everywhere(case: str) -> None:
    """Exact-stop window behind the relaxing motion, 1 um at the force, kernel on its cycle."""
    row = ROWS[case]
    if case in RELAXED:
        return
    for name, column in (("Z", "relax_lag_mm"), ("X", "relax_lag_mm:X"), ("Y", "relax_lag_mm:Y")):
        if row[f"check:{column}"]:
            window = next(each for each in _known(case) if each.name == name).window_mm
            assert row[f"check:{column}"] == f"-{window:g} .. {window:g}"
    assert row["check:latch_force_error_um"] in ("", "-1 .. 1")
    assert row["check:after_run_motion_um"] == ""
    assert row["check:detection_followed_error_ms"] in ("", "== 0")


@pytest.mark.parametrize("case", RELAXED)
def test_lag_that_the_relaxing_motion_leaves(case: str) -> None:
    """An increment: the motor is at its limit until e = 0; with feed-forward the axis creeps back.

    Behind the run it may move by no more than that lag, whatever becomes of the torque limit.
    """
    row, found = ROWS[case], axis(ROWS[case])
    low, high = found.left_lag() if found.plant("feed_forward") else (-1e-5, 1e-5)
    told_low, told_high = band(row["check:relax_lag_mm"])
    assert is_rounded(told_low, low, 5)
    assert is_rounded(told_high, high, 5)
    assert high < found.window_mm
    assert abs(found.increment - 1e-5) < 5e-7
    if "restored" in row["tags"].split():
        assert is_rounded(most(row["check:after_run_motion_um"]), high * 1e3, 2)


def test_relaxed_with_the_window_inside_and_outside_of_the_penetration() -> None:
    pressed, soft = axis(ROWS["restored-feed-forward"]), axis(ROWS["restored-soft"])
    assert soft.penetration[1] < soft.window_mm == pressed.window_mm < pressed.penetration[0]


def test_what_the_plan_is_about() -> None:
    known = [each for case in ROWS for each in _known(case)]
    assert len(ROWS) >= 60
    assert {each.k / 1e3 for each in known} == {20, 50, 100, 200, 500}
    assert {each.plant("stop_damping") for each in known} >= {0, 20, 60, 200}
    assert {each.direction for each in known} == {1, -1}
    assert {each.model for each in known} == {"ServoAxis", "GravityAxis", "ScrewAxis"}
    assert {each.plant("backlash_um") for each in known} == {0, 20}
    assert any(each.stop_speed for each in known)
    numbers = {int(row["requirement"].removeprefix("R-STOP-")) for row in ROWS.values()}
    assert numbers == set(range(1, max(numbers) + 1))
    assert all(row["title"] and row["tags"] for row in ROWS.values())
