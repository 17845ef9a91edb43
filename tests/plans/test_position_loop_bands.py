"""Limits of testplans/position_loop.csv from closed forms; nothing of the bench is imported.

At the latch the axis is at x. The NC cycle that reads the latch has read the actual position
x + v t of the same SYNC, t = 0 to T after it; the cycle before has sent the last set position at
full speed, (1 - f) v/Kv further than its actual position x + v (t - T). From there the path
brakes: v^2/2a. The exact stop lets an axis be as far from its end as its window. Frames are no
part of it, so that CAN and EtherCAT are alike.
"""

import csv
import re
import tomllib
from pathlib import Path

import pytest

PLANS = Path(__file__).parents[2] / "testplans"
DELAY_S, PERIOD_S, A_MM_S2, WINDOW_MM = 4e-6, 1e-3, 1000.0, 1e-4
"""Of the rigs and lists; the first test holds them to the files."""
INCREMENT_MM = 10.0 / 1_048_576
STOP_MM, AT_STOP_MM = 102.0, 102.02502  # F/k of 500.4 N and 20 N/um, as in fixed_stop_timing.csv
MIN_TIME_MS, STOP_KV = 65.0, 20.0


def _rows() -> dict[str, dict[str, str]]:
    with (PLANS / "position_loop.csv").open(encoding="utf-8", newline="") as file:
        return {row["case"]: row for row in csv.DictReader(file)}


ROWS = _rows()
PROBES = [name for name, row in ROWS.items() if row["program"] == "programs/position-loop.nc"]


def _list(name: str) -> str:
    return (PLANS / "rigs" / "lists" / name).read_text(encoding="utf-8")


def _set(row: dict[str, str], name: str) -> float | None:
    found = re.search(rf"{re.escape(name)}=(\d+)", row["inputs"])
    return None if found is None else float(found[1])


def _gain(row: dict[str, str]) -> float:
    return (_set(row, "set:Z.getriebe[0].kv") or 1000.0) / 100.0


def _forward(row: dict[str, str]) -> float:
    if not _set(row, "default_active") or _set(row, "global_disable"):
        return 0.0
    return 1.0 / (_set(row, "vs_v_nenner") or 1.0)


def test_the_figures_used_here_are_those_of_the_rigs() -> None:
    for name in ("probe-z.toml", "probe-z-ethercat.toml"):
        rig = tomllib.loads((PLANS / "rigs" / name).read_text(encoding="utf-8"))
        assert rig["drive"]["servo"]["input_delay_us"] / 1e6 == DELAY_S
        assert rig["drive"]["servo"]["encoder_increments"] == 1_048_576
        assert rig["cycle"]["period_us"] / 1e6 == PERIOD_S
    for name in ("axis-z-velocity.lst", "axis-z-fine.lst"):
        assert re.search(r"a_grenz_stufe_1\s+1000 ", _list(name))
        assert re.search(r"getriebe\[0\].window\s+1 ", _list(name))
    assert re.search(r"getriebe\[0\].kv\s+1000 ", _list("axis-z-velocity.lst"))


def test_a_lag_has_settled_to_a_tenth_of_a_micrometre_before_the_contact() -> None:
    """What is left of v/Kv falls with e^(-Kv t)."""
    for name in PROBES:
        row = ROWS[name]
        speed, gain = float(row["plc:V.E.FEED"]) / 60.0, _gain(row)
        seconds = (float(row["plc:V.E.FROM"]) - 100.0) / speed
        assert speed / gain * 2.718281828 ** (-gain * seconds) < 1e-4, name


@pytest.mark.parametrize("name", PROBES)
def test_lag_and_place_of_a_run(name: str) -> None:
    row = ROWS[name]
    speed, gain, forward = float(row["plc:V.E.FEED"]) / 60.0, _gain(row), _forward(row)
    lag_mm = (1.0 - forward) * speed / gain
    if row["check:lag_mm_max"]:
        assert row["check:lag_mm_max"] == f"{lag_mm:.5f} +- 0.00001"
        assert INCREMENT_MM < 1e-5
    assert row["check:latch_error_um"] == f"{-speed * DELAY_S * 1e3:.4f} +- 0.0095"
    high = speed * speed / (2.0 * A_MM_S2) + lag_mm + speed * DELAY_S
    low = high - speed * PERIOD_S - WINDOW_MM
    if forward < 1.0:
        assert row["check:overtravel_mm"] == f"{low:.5f} .. {high:.5f}"
    else:  # it goes past its end and comes back to it, from whichever side
        place = f"standstill_mm = {100 - high - WINDOW_MM:.5f} .. {100 - low:.5f}"
        assert row["checks"].startswith(place)


def test_a_stop_is_found_by_the_lag_that_the_controller_has_computed() -> None:
    """e = v t + v/Kv - F/k after the contact is above the limit at the first SYNC after t.

    An NC cycle, 0.6 ms after its SYNC, looks at what the one before has computed, and the time of
    the criterion follows: 1.6 to 2.6 ms and MIN_TIME after t. The contact is stiff: 0.1 ms for
    0.17 um of its place.
    """
    row = ROWS["stop-f100"]
    speed = float(row["plc:V.E.FEED"]) / 60.0
    limit_mm = (_set(row, "pos_lag_limit") or 0.0) / 1e4
    assert (_set(row, "min_time"), _gain(row)) == (MIN_TIME_MS * 1e3, STOP_KV)
    above_ms = (limit_mm + AT_STOP_MM - STOP_MM - speed / STOP_KV) / speed * 1e3
    low, high = above_ms + MIN_TIME_MS + 1.6 - 0.1, above_ms + MIN_TIME_MS + 2.6 + 0.1
    assert row["checks"].startswith(f"contact_to_detection_ms = {low:.1f} .. {high:.1f} ;;")
    for name, is_above in (("stop-lag-above", True), ("stop-lag-below", False)):
        limit_mm = (_set(ROWS[name], "pos_lag_limit") or 0.0) / 1e4
        assert (limit_mm > speed / STOP_KV) is is_above
        assert abs(limit_mm - speed / STOP_KV) < 2e-4
        assert f"found_without_contact == {int(not is_above)}" in ROWS[name]["checks"]
