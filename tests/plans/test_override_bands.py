"""Limits of testplans/override.csv from closed forms; nothing of the bench is imported.

The speed is o F, within what the axis may do; from it follow lag v/Kv, latch, reaction and way.
"""

import csv
import re
import tomllib
from decimal import Decimal
from pathlib import Path

import pytest

PLANS = Path(__file__).parents[2] / "testplans"
HUNDRED = Decimal(100)
SYNC_MS = Decimal("0.048")  # tests/plans/test_shipped_bands.py counts its bits


def _rows() -> dict[str, dict[str, str]]:
    with (PLANS / "override.csv").open(encoding="utf-8", newline="") as file:
        return {row["case"]: row for row in csv.DictReader(file)}


ROWS = _rows()
MEASURED = [name for name, row in ROWS.items() if "measuring" in row["tags"]]
RAPID = [name for name, row in ROWS.items() if "rapid" in row["tags"]]
DISTANCE = [name for name, row in ROWS.items() if "distance" in row["tags"]]


def _list(name: str, row: dict[str, str], parameter: str) -> Decimal:
    """A value of the axis list, or of the row, in the list's unit."""
    if row.get(f"set:Z.{parameter}"):
        return Decimal(row[f"set:Z.{parameter}"])
    text = (PLANS / "rigs" / "lists" / name).read_text(encoding="utf-8")
    match = re.search(rf"^{re.escape(parameter)}\s+(\d+)", text, re.M)
    assert match is not None
    return Decimal(match[1])


def _overrides(cell: str, most: Decimal) -> list[Decimal]:
    """The overrides of a cell, in their order, as shares; without one 100 %."""
    values = [Decimal(part.split()[0]) for part in cell.split(";")] if cell else [HUNDRED]
    return [min(value, most) / HUNDRED for value in values]


def _speeds(row: dict[str, str], full: Decimal, limit: Decimal) -> tuple[Decimal, Decimal]:
    """Largest and last speed of a motion: F at 100 %, times path, times axis, within its limit."""
    most = Decimal(row["set:channel.max_vb_override"] or 1000) / 10  # P-CHAN-00056, 0.1 %
    path, (axis,) = (
        _overrides(row["plc:override"], most),
        _overrides(row["plc:Z.override"], HUNDRED),
    )
    speeds = [min(full * share * axis, limit) for share in path]
    return max(speeds), speeds[-1]


def _probe_speeds(row: dict[str, str]) -> tuple[Decimal, Decimal]:
    limit = _list("axis-z-fine.lst", row, "getriebe[0].dynamik.vb_max") / 1000
    return _speeds(row, Decimal(row["plc:V.E.FEED"]) / 60, limit)


def _is(text: str, value: Decimal, digits: int) -> bool:
    assert len(text.partition(".")[2]) == digits, text
    return abs(Decimal(text) - value) <= Decimal(5).scaleb(-digits - 1)


def _parts(text: str) -> tuple[str, str]:
    low, _, high = text.partition(" .. ") if ".." in text else text.partition(" +- ")
    return low, high


def test_the_plan_has_the_cases_that_it_is_about() -> None:
    for axis in ("path", "axis"):
        column = "plc:override" if axis == "path" else "plc:Z.override"
        assert [ROWS[f"{axis}-{o}"][column] for o in (1, 50, 99)] == ["1", "50", "99"]
    assert [ROWS[name]["plc:Z.override"] for name in DISTANCE] == ["50", "1"]
    assert len(MEASURED) == 14


@pytest.mark.parametrize("case", MEASURED)
def test_speed_and_lag_of_a_measuring_block(case: str) -> None:
    row = ROWS[case]
    rig = tomllib.loads((PLANS / row["rig"]).read_text(encoding="utf-8"))
    fastest, last = _probe_speeds(row)
    speed, width = _parts(row["check:velocity_mm_s_max"])
    assert (_is(speed, fastest, 3), width) == (True, "0.001")
    speed, width = _parts(row["check:contact_velocity_mm_s"])
    assert (_is(speed, -last, 3), width) == (True, "0.001")
    lag, width = _parts(row["check:drive_lag_mm_max"])
    assert (_is(lag, fastest / rig["plant"]["z"]["start"]["kv"], 4), width) == (True, "0.0001")


@pytest.mark.parametrize("case", MEASURED)
def test_latch_reaction_and_way_behind_the_contact(case: str) -> None:
    """As tests/plans/test_shipped_bands.py, at the speed of the contact: o F.

    v (t_l - t_c + T) + v²/2a + v/Kv, and U in [0, T) makes the band v T wide.
    """
    row = ROWS[case]
    rig = tomllib.loads((PLANS / row["rig"]).read_text(encoding="utf-8"))
    drive, start = rig["drive"]["servo"], rig["plant"]["z"]["start"]
    _, v = _probe_speeds(row)
    period = Decimal(rig["cycle"]["period_us"]) / 10**6
    delay = Decimal(str(drive["input_delay_us"])) / 10**6
    a = _list("axis-z-fine.lst", row, "getriebe[0].lslope_profil.a_grenz_stufe_1")
    assert v < 100, "the second step of the slope would need its own term"
    low, high = _parts(row["check:latch_error_um"])
    assert _is(low, -v * delay * 1000, 4)
    assert _is(high, Decimal(str(drive["lead_mm"])) / drive["encoder_increments"] * 1000, 4)
    low, high = _parts(row["check:contact_to_latch_ms"])
    assert (_is(low, delay * 1000, 5), high) == (True, "0.00001")
    low, high = _parts(row["check:reaction_ms"])
    least_ms = delay * 1000 + Decimal(rig["cycle"]["cycle_offset_us"]) / 1000 - SYNC_MS
    assert _is(low, least_ms, 3)
    assert _is(high, least_ms + period * 1000, 3)
    way = v * (delay + period) + v * v / (2 * a) + v / start["kv"]
    low, high = _parts(row["check:overtravel_mm"])
    assert _is(low, way, 5)
    assert _is(high, way + v * period, 5)
    surface = Decimal(rig["plant"]["probe"]["start"]["surface_mm"])
    low, high = _parts(row["check:standstill_mm"])
    assert _is(low, surface - way - v * period, 5)
    assert _is(high, surface - way, 5)
    assert (row["check:msg:N20"], row["check:alarms"]) == ("== 1", "none")


@pytest.mark.parametrize("case", RAPID)
def test_rapid_traverse_is_scaled_and_never_above_its_speed(case: str) -> None:
    row = ROWS[case]
    rapid = Decimal(row["set:Z.getriebe[0].vb_eilgang"]) / 1000
    fastest, _ = _speeds(row, rapid, rapid)
    speed, width = _parts(row["check:velocity_mm_s_max"])
    assert (_is(speed, fastest, 3), width) == (True, "0.001")
    lag, width = _parts(row["check:drive_lag_mm_max"])
    assert (_is(lag, fastest / 40, 4), width) == (True, "0.0001")
    assert row["check:alarms"] == "none"


@pytest.mark.parametrize("case", DISTANCE)
def test_the_override_of_the_axis_scales_v_max_of_the_offset(case: str) -> None:
    """The step in a cycle is o v_max T; the surface is 0.4 mm above SET_POS."""
    row = ROWS[case]
    v = Decimal(row["set:Z.kenngr.distc.v_max"]) / 1000 * Decimal(row["plc:Z.override"]) / 100
    speed, width = _parts(row["check:offset_speed_mm_s_max"])
    assert (Decimal(speed), width) == (v, "0.000001")
    program = (PLANS / row["program"]).read_text(encoding="utf-8")
    rig = tomllib.loads((PLANS / row["rig"]).read_text(encoding="utf-8"))
    set_pos = re.search(r"SET_POS=([\d.]+)", program)
    assert set_pos is not None
    height = rig["plant"]["gap"]["start"]["workpiece.plane.level_mm"] - Decimal(set_pos[1])
    reached = v * Decimal(row["plc:V.E.TIME"])
    end, width = _parts(row["check:offset_mm_max"])
    assert Decimal(end) == min(height, reached)
    # there to 0.1 um, or on the way by one cycle
    assert Decimal(width) == (Decimal("0.0001") if reached > height else v / 1000)
    assert row["check:offset_model_error_um"] == "<= 0.001"
