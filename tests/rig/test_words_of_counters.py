"""What a rig says of the increments of drives that are no CiA 402 drives, by closed forms."""

from pathlib import Path

import pytest

from axisrig.bench.rig.reading.file import read_rig

RIGS = Path(__file__).parents[2] / "testplans" / "rigs"


@pytest.mark.parametrize("rig", ["fixed-stop-z-conventional", "fixed-stop-z-encoder-terminal"])
@pytest.mark.parametrize(("lines", "lead_mm"), [(2500, 10.0), (1024, 10.0), (5000, 4.0)])
def test_a_line_counts_four_times_and_an_increment_has_its_length(
    rig: str, lines: int, lead_mm: float
) -> None:
    table, _ = read_rig(RIGS / f"{rig}.toml")
    (drive,) = table.drive.values()
    words = drive.model_copy(update={"lines": lines, "lead_mm": lead_mm}).in_words
    assert f"{lines} lines a turn counted four times" in words
    assert f" {lead_mm * 1000 / (4 * lines):.4g} um an increment" in words


@pytest.mark.parametrize(("variable", "mode"), [("LATCH32", 26), ("LATCH16", 0)])
def test_a_lightbus_drive_says_where_it_latches(variable: str, mode: int) -> None:
    table, _ = read_rig(RIGS / "fixed-stop-z-lightbus.toml")
    (drive,) = table.drive.values()
    changed = drive.model_copy(update={"latch_variable": variable, "in2mode": mode})
    assert f"latched in {variable}, IN2MODE {mode}" in changed.in_words
