"""Limits of the plan of older parameters, recomputed from its rig: which probe has signalled.

Nothing of the bench is imported. Each of the three probes sees another height, so a measured value
cannot come from the wrong one.
"""

import math
import tomllib

import pytest
from tests.plans.shipped_files import PLANS, limits, rows_of

RIG = tomllib.loads((PLANS / "rigs/probes-older.toml").read_text(encoding="utf-8"))
V_MM_S, START_MM, TARGET_MM = 10.0, 105.0, 98.0  # F600 and the blocks of the programs
INCREMENT_MM = 10.0 / 2**20
CYCLE_MM = V_MM_S * 1e-3
A_MM_S2 = 1000.0  # P-AXIS-00005


ROWS = rows_of("older_parameters")


def _of_input(plant: str) -> tuple[float, float]:
    """Surface less v t of the input of the drive, to an increment."""
    at = RIG["plant"][plant]["start"]["surface_mm"]
    at -= V_MM_S * RIG["drive"]["servo"]["input_delay_us"] * 1e-6
    return at - INCREMENT_MM, at + INCREMENT_MM


def _of_plc() -> tuple[float, float]:
    """0 to a cycle of the PLC late, 0.3 ms to the NC cycle, 552 us of age of its position."""
    at, plc = RIG["plant"]["third"]["start"]["surface_mm"], RIG["plc"]
    after_us = RIG["cycle"]["cycle_offset_us"] - plc["offset_us"]
    least_us = after_us - (RIG["cycle"]["cycle_offset_us"] - 48)
    most_us = least_us + plc["period_us"]
    return at - V_MM_S * most_us * 1e-6 - INCREMENT_MM, at - V_MM_S * least_us * 1e-6 + INCREMENT_MM


EXPECTED = {
    "probe": _of_input("probe"),
    "second": _of_input("second"),
    "third": _of_plc(),
}
BY = {
    "probe": "none p113 p116 p117 p269 p269-p113 p430-over-p295 p516-over-p257 p517-over-p430 "
    "p518-over-p113 probe1-p539",
    "second": "p295 p430 p430-p113 probe1-p430",
    "third": "p115 p115-p113 p257 p257-p113 p257-over-p269 p516-over-p116",
}


@pytest.mark.parametrize("plant", BY)
def test_a_row_expects_the_probe_of_its_parameter(plant: str) -> None:
    for case in BY[plant].split():
        row = ROWS[case]
        for column in ("check:msg:N40", "check:msg:N80"):
            if row[column]:
                assert limits(row[column]) == pytest.approx(EXPECTED[plant], abs=1e-6), case


def test_simulated_probes_have_the_set_position_of_their_condition() -> None:
    """Down at v: the first cycle after a place is up to v T past it; mode 2: n T less v²/2a."""
    way = START_MM - TARGET_MM
    assert limits(ROWS["p112-1"]["check:msg:N40"]) == pytest.approx((100.5 - CYCLE_MM, 100.5))
    cycles = float(ROWS["p112-2"]["set:Z.meas_simu.parameter1"])
    at = START_MM - (cycles * CYCLE_MM - V_MM_S**2 / (2 * A_MM_S2))
    low, high = limits(ROWS["p112-2"]["check:msg:N40"])
    assert (low, high) == pytest.approx((at - CYCLE_MM, at + CYCLE_MM), abs=2e-5)
    rest = TARGET_MM + float(ROWS["p112-3"]["set:Z.meas_simu.parameter1"]) / 100 * way
    assert limits(ROWS["p112-3"]["check:msg:N40"]) == pytest.approx((rest - CYCLE_MM, rest))
    for case in ("p112-4", "p112-5", "p112-over-p257"):
        assert limits(ROWS[case]["check:msg:N40"]) == pytest.approx((98.0, 98.0), abs=2e-5)


def test_a_body_is_touched_where_its_geometry_has_it() -> None:
    """Down at v onto a face, a pole, and the smaller of both; to a cycle."""

    def mm(row: dict[str, str], axis: str, number: int) -> float:
        return float(row[f"set:{axis}.meas_simu.parameter{number}"] or 0) * 1e-4

    box, pole = ROWS["p112-6-box"], ROWS["p112-6-round"]
    for row, at in ((box, mm(box, "Z", 2)), (pole, mm(pole, "Z", 3) + mm(pole, "Z", 4))):
        assert limits(row["check:msg:N40"]) == pytest.approx((at - CYCLE_MM, at), abs=2e-5)
    cut = limits(ROWS["p112-6-list"]["check:msg:N40"])  # 97 to 100.5, and 99 +- 2
    assert cut == pytest.approx((100.5 - CYCLE_MM, 100.5), abs=2e-5)


def test_a_sphere_is_touched_beside_its_middle() -> None:
    """X and Z from (0, 104) to (6, 96) at Y 0: the circle around (6, 96) in that plane."""
    row = ROWS["p112-6-sphere"]
    centre = {axis: float(row[f"set:{axis}.meas_simu.parameter3"]) * 1e-4 for axis in "XYZ"}
    radius = float(row["set:X.meas_simu.parameter4"]) * 1e-4
    assert (centre["X"], centre["Z"]) == (6.0, 96.0)  # the target of the run
    way = math.sqrt(radius**2 - centre["Y"] ** 2)
    x, z = 6.0 - 0.6 * way, 96.0 + 0.8 * way
    low, high = limits(row["check:latch_mm:X"])
    assert (low, high) == pytest.approx((x, x + 0.6 * CYCLE_MM), abs=2e-5)
    low, high = limits(row["check:latch_mm:Z"])
    assert (low, high) == pytest.approx((z - 0.8 * CYCLE_MM, z), abs=2e-5)


def test_every_older_parameter_of_measuring_has_a_row() -> None:
    """P-AXIS-00539 and 00145 to 00148 are in the lists of their rigs."""
    columns = {
        "kenngr.mess_neg_flanke",
        "kenngr.mess_signal_achs_steuer",
        "kenngr.mess_signal_sercos",
        "kenngr.mess_signal_taster",
        "kenngr.probing_signal_via_plc",
        "kenngr.meas_signal_drive",
        "kenngr.meas_signal_fixed_stop",
        "antr.canopen.probing_input_number",
        "antr.probing_input_nbr",
        "meas_simu.meas_simu_mode",
    }
    for name in columns:
        assert any(row[f"set:Z.{name}"] not in ("", "0") for row in ROWS.values()), name
    lists = PLANS / "rigs/lists"
    body = (lists / "axis-z-older-sphere.lst").read_text(encoding="utf-8")
    assert all(f"meas_simu.parameter{number}" in body for number in (1, 2, 3, 4))
    banding = (lists / "axis-z-older-banding.lst").read_text(encoding="utf-8")
    assert "kenngr.measure.input_edge_banding" in banding
