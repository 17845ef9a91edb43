"""Limits of testplans/reset.csv from closed forms; nothing of the bench is imported."""

import csv
import re
import tomllib
from pathlib import Path

import pytest

PLANS = Path(__file__).parents[2] / "testplans"
DELAY_S, PERIOD_S, A_MM_S2, KV = 4e-6, 1e-3, 1000.0, 40.0
"""Of rigs/probe-z.toml and its list; the first test holds them to the files."""


def _rows() -> dict[str, dict[str, str]]:
    with (PLANS / "reset.csv").open(encoding="utf-8", newline="") as file:
        return {row["case"]: row for row in csv.DictReader(file)}


ROWS = _rows()


def _program(name: str) -> str:
    return (PLANS / "programs" / name).read_text(encoding="utf-8")


def _middle(text: str) -> float:
    middle, width = text.split(" +- ")
    assert width == "0.0001"
    return float(middle)


def test_the_figures_used_here_are_those_of_the_rig() -> None:
    rig = tomllib.loads((PLANS / "rigs" / "probe-z.toml").read_text(encoding="utf-8"))
    drive, start = rig["drive"]["servo"], rig["plant"]["z"]["start"]
    figures = drive["input_delay_us"] / 1e6, rig["cycle"]["period_us"] / 1e6, start["kv"]
    assert figures == (DELAY_S, PERIOD_S, KV)
    text = (PLANS / "rigs" / "lists" / "axis-z-fine.lst").read_text(encoding="utf-8")
    assert re.search(r"a_grenz_stufe_1\s+1000 ", text)
    assert "N30 G1 G90 Z120" in _program("reset-probe.nc")


def test_each_state_of_distance_control_and_of_a_run_has_its_row() -> None:
    assert {"armed", "approaching", "braking", "with-result", "again"} <= set(ROWS)
    states = {"inactive", "active", "freeze", "turning-off", "active-const-dist", "error"}
    assert states <= set(ROWS)
    for name in states:
        row = ROWS[name]
        assert row["plc:program_start"] == "at=reset+100ms file=reset-distance.nc"
        # behind ON, OFF and the end of the offset the axis is where the program says
        assert _middle(row["check:msg:N70"]) == 37.0
        assert (row["check:offset_end_mm"], row["check:distance_state_end"]) == (
            "== 0",
            "== INACTIVE",
        )


@pytest.mark.parametrize(("case", "seconds"), [("armed", 0.0), ("approaching", 0.5)])
def test_a_run_that_is_reset_on_its_way_stands_v_t_behind_its_start(
    case: str, seconds: float
) -> None:
    """v t - v²/2a at the reset, and v²/2a to stop: v t."""
    row = ROWS[case]
    speed_mm_s = float(row["plc:V.E.FEED"]) / 60
    assert _middle(row["check:msg:N20.2"]) == 120.0 - speed_mm_s * seconds


def test_a_run_that_is_reset_while_it_brakes_stands_where_its_edge_puts_it() -> None:
    """v (t_l - t_c + T) + v²/2a + v/Kv, and v T more: the reset comes within v/a of the edge."""
    row = ROWS["braking"]
    v = float(row["plc:V.E.FEED"]) / 60
    way = v * (DELAY_S + PERIOD_S) + v * v / (2 * A_MM_S2) + v / KV
    low, high = row["check:msg:N20.2"].split(" .. ")
    assert float(low) == pytest.approx(100 - way - v * PERIOD_S, abs=5.1e-6)
    assert float(high) == pytest.approx(100 - way, abs=5.1e-6)
    contact_s = (20 + v * v / (2 * A_MM_S2) + v / KV) / v  # of the demand from its first cycle on
    match = re.fullmatch(r"at=motion\+(\d+)ms nth=2", row["plc:reset"])
    assert match is not None
    latest_s = contact_s + DELAY_S + 2 * PERIOD_S
    assert latest_s < int(match[1]) / 1e3 < contact_s + v / A_MM_S2


def test_no_program_finds_the_result_of_another_one() -> None:
    for name, row in ROWS.items():
        if "measuring" in row["tags"] and row["check:msg:N10.2"]:
            assert row["check:msg:N10.2"] == "== 0", name
    assert ROWS["result-asked"]["check:alarms"] == "== 900101"
    assert "V.A.MESS.Z" in _program("reset-result.nc")
    for name in ("armed", "approaching", "braking"):  # the value is of the second start alone
        assert ROWS[name]["check:msg:N50.1"] == "== 1"
        feed = float(ROWS[name]["plc:V.E.FEED"]) / 60
        middle, _ = ROWS[name]["check:latch_error_um"].split(" +- ")
        assert float(middle) == pytest.approx(-feed * DELAY_S * 1e3, abs=1e-9)


def test_alarms_of_all_programs_count_in_their_order() -> None:
    """Both find no signal; the start before the reset is refused in between."""
    row = ROWS["behind-an-alarm"]
    assert row["plc:program_start"] == "at=program_end+10ms; at=reset+100ms"
    assert row["plc:reset"] == "at=program_end+20ms"
    assert row["check:alarms"] == "== 900004 900290 900004"


def test_the_offset_that_a_reset_leaves() -> None:
    rig = tomllib.loads((PLANS / "rigs" / "distance-z.toml").read_text(encoding="utf-8"))
    z = rig["plant"]["z"]["start"]["position_start_mm"]
    gap = z - rig["plant"]["gap"]["start"]["workpiece.plane.level_mm"]
    lift = float(ROWS["active"]["plant:gap.lift_mm"])
    assert _middle(ROWS["inactive"]["check:msg:N10.1"]) == z
    assert _middle(ROWS["active"]["check:msg:N10.1"]) == z + lift
    assert _middle(ROWS["freeze"]["check:msg:N10.1"]) == z + lift
    wanted = 1.8
    assert f"set_dist={wanted}" in ROWS["active-const-dist"]["plc:Z.dist_ctrl"]
    kept = z + lift + wanted - gap
    assert _middle(ROWS["active-const-dist"]["check:msg:N10.1"]) == pytest.approx(kept)
    row = ROWS["turning-off"]
    assert row["plc:Z.dist_ctrl"].endswith("OFF at=350ms")
    assert row["plc:reset"] == "at=400ms"
    run_out = float(row["set:Z.kenngr.distc.v_max"]) / 1e3 * 50e-3  # a_max reaches v_max at once
    assert _middle(row["check:msg:N10.1"]) == pytest.approx(z + lift - run_out)
