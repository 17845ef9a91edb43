"""Limits of the printed examples, recomputed from what FCT-C4 prints; and that they are all there.

Nothing of the bench is imported. Programs are compared word by word with the print, errata applied.
"""

import math
import re

import pytest
from tests.plans.shipped_files import PLANS, limits, rows_of

V_MM_S = 500 / 60  # F500
SIGNAL_S = 0.3  # plc:X.probing_signal
KV, A_MM_S2, CYCLE_S = 40.0, 1000.0, 1e-3


ROWS = rows_of("manual_examples")


PRINTED = {
    "manual-meas-run": "N10 G00 X0 Y0 Z0 N20 X5 N30 G100 X10 Y10 F500 N40 G01 X7 N50 M30",
    "manual-independent": "N10 G0 X0 Y0 N20 X[INDP_SYN G100 G90 POS100 FEED500] \\ "
    "Y[INDP_SYN G100 G90 POS100 FEED1000] N30 M30",
    "manual-standard": "N10 G00 X0 Y1 Z0 N20 X5 N30 G100 X10 F500 N40 G01 Y3 N50 G100 Y10 F500 "
    "N60 G01 X10 Y5 N70 G100 X15 Y10 F500 N100 M30",
    "manual-cs": "N10 G00 X0 Y1 Z0 N20 #CS ON[0,0,0,0,45] N30 G100 X10 F500 N40 #CS OFF "
    "N50 #CS ON[0,0,0,0,0,90] N60 G100 X10 F500 N70 #CS OFF N100 M30",
}


@pytest.mark.parametrize("name", PRINTED)
def test_a_program_is_the_printed_one(name: str) -> None:
    text = (PLANS / f"programs/{name}.nc").read_text(encoding="utf-8")
    blocks = [line.split(";")[0] for line in text.splitlines() if not line.startswith("%")]
    assert " ".join(" ".join(blocks).split()) == PRINTED[name]


@pytest.mark.parametrize(
    ("file", "printed"),
    [
        ("manual-example", "D1\nG0 X150 Z200\nG100 Z20\n"),
        ("manual-7-2", "#MEAS PREPARE [AXNR = 3]"),  # printed for any axis
        ("manual-7-5", "#MEAS [ AXNR=2 SIGNAL=PLC_TIMESTAMP]"),  # axis 2 of its example
    ],
)
def test_printed_lines_are_in_a_program(file: str, printed: str) -> None:
    text = (PLANS / f"programs/{file}.nc").read_text(encoding="utf-8")
    text = re.sub(r"^N20 #MEAS MODE\[1\]\n", "", text, flags=re.M)
    assert printed in text


SECTION_3 = {
    "kenngr.messachse": "1",
    "kenngr.hub_messtaster": "100000",
    "kenngr.vb_messen": "10000",
    "kenngr.probing_offset": "0",
    "kenngr.measure.signal": "PLC",
    "kenngr.measure.input": "1",
    "kenngr.measure.edge": "POS",
}


def test_the_list_of_section_3_is_the_printed_one() -> None:
    text = (PLANS / "rigs/lists/axis-z-plc.lst").read_text(encoding="utf-8")
    found = dict(line.split()[:2] for line in text.splitlines() if line.startswith("kenngr."))
    assert found == SECTION_3


def test_the_lists_of_7_2_and_7_4_are_the_printed_ones() -> None:
    """7.2: input 1 or 2, POS or NEG; 7.4: input 4, NEG."""
    names = ("signal", "input", "edge")
    found = {
        tuple(row[f"set:Z.kenngr.measure.{name}"] for name in names)
        for case, row in ROWS.items()
        if case.startswith("list-7-2") or case == "list-7-4"
    }
    assert found == {
        *(("EXT_PROBE_WITH_DRIVE", i, edge) for i in "12" for edge in ("POS", "NEG")),
        ("PLC_EXT_LATCH_CONTROL", "4", "NEG"),
    }
    for case in ("list-7-2-1-pos", "list-7-2-2-neg", "list-7-4", "meas-7-4"):
        by_list = case.startswith("list")
        row = ROWS[case]
        number = row["set:Z.kenngr.measure.input"] if by_list else "4"
        falling = "0" if row["set:Z.kenngr.measure.edge"] == "POS" else "1"
        assert row["check:msg:N70"] == f"== {number}"
        assert row["check:msg:N80"] == f"== {falling}"


def _way_mm(seconds: float) -> float:
    """Way at v so long after its path has begun, ramp and lag taken off."""
    return V_MM_S * seconds - V_MM_S**2 / (2 * A_MM_S2) - V_MM_S / KV


@pytest.mark.parametrize(
    ("case", "axis", "start_mm", "share"),
    [
        ("standard", "X", 10.0, math.sqrt(0.5)),  # N70 from (10, 5) to (15, 10)
        ("standard", "Y", 5.0, math.sqrt(0.5)),
        ("cs", "Y", 1.0, 1.0),  # X of a system that is turned by 90 degrees
    ],
)
def test_a_signal_of_the_plc_comes_so_long_after_the_run_begins(
    case: str, axis: str, start_mm: float, share: float
) -> None:
    """The path begins up to 4 cycles after the run, and the value is up to one cycle old."""
    low, high = limits(ROWS[case][f"check:latch_mm:{axis}"])
    assert low == pytest.approx(start_mm + share * _way_mm(SIGNAL_S - 5 * CYCLE_S), abs=2e-5)
    assert high == pytest.approx(start_mm + share * _way_mm(SIGNAL_S), abs=2e-5)


def test_both_walls_are_on_the_line_of_the_first_program() -> None:
    """From (5, 0) to (10, 10): y = 2 (x - 5)."""
    row = ROWS["meas-run"]
    x_mm, y_mm = float(row["plant:stop_x.low_mm"]), float(row["plant:stop_y.low_mm"])
    assert y_mm == 2 * (x_mm - 5)
    assert limits(row["check:latch_mm:X"]) == pytest.approx((x_mm, x_mm), abs=2e-5)
    assert limits(row["check:latch_mm:Y"]) == pytest.approx((y_mm, y_mm), abs=2e-5)


def test_the_stroke_of_the_list_lowers_type_4() -> None:
    """sqrt(2 a s) with 10 mm and 1000 mm/s2; what the ramp of the loop lacks is below 0.05 mm/s."""
    highest = math.sqrt(2 * A_MM_S2 * float(SECTION_3["kenngr.hub_messtaster"]) * 1e-4)
    middle, width = ROWS["list-3-type-4"]["check:contact_velocity_mm_s"].split(" +- ")
    assert -float(middle) == pytest.approx(highest, abs=1e-4)
    way_mm = 110.374 - float(ROWS["list-3-type-4"]["plant:probe.surface_mm"])
    seconds = (way_mm - highest**2 / (2 * A_MM_S2)) / highest
    assert A_MM_S2 / KV * math.exp(-KV * seconds) < float(width)
