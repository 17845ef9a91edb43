"""What the frames of a run have of a latch: the AT of the drive, as a log shows it."""

import subprocess
import sys
from pathlib import Path

import pytest

PLAN = Path(__file__).parents[2] / "testplans" / "sercos.csv"


@pytest.mark.long
def test_the_at_of_the_recording_has_the_place_in_increments(tmp_path: Path) -> None:
    """12.3456 mm are 1 294 529.99 of 2^20 in 10 mm; first in an AT, then by the service channel."""
    axisrig = [sys.executable, "-m", "axisrig.bench.cli"]
    run = ["run", str(PLAN), "-k", "at-12-3456", "-o", str(tmp_path / "out"), "-j", "1", "-q"]
    subprocess.run([*axisrig, *run], check=True, capture_output=True)
    show = ["bus", str(tmp_path / "out"), "sercos-at-12-3456", "--only", "S-0-0130"]
    log = subprocess.run([*axisrig, *show], check=True, capture_output=True, text=True).stdout
    lines = log.splitlines()
    first = next(line for line in lines if "S-0-0130 1294530" in line)
    assert "Z.inputs" in first
    assert "S-0-0135 0xC0" in first
    answers = [line for line in lines if "SoE answer S-0-0130 = " in line]
    assert [line.rpartition(" ")[2] for line in answers] == ["1294530"]
