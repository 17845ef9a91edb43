"""The four programs of the manual as a user runs them: what stands on standard output, to the line.

The numbers are worked out here from MESS = what the probe met in the system of the run,
MOFFS = MESS - PROG - zero shifts, ABS = PROG + zero shifts + MEIN (physics.md 2(g) for meas4).
"""

import math
import re
import subprocess
import sys
from pathlib import Path

import pytest

from axisrig.fmus import MODELS, ensure_built

pytestmark = pytest.mark.long

ROOT = Path(__file__).parents[2]
PROGRAMS = ROOT / "testplans" / "programs"
RIGS = ROOT / "testplans" / "rigs"
# One increment of 20 bit on 10 mm; %f rounds once more; pre-travel of these rigs is 0
TOLERANCE_MM = 10 / 2**20 + 0.5e-6

NAMES = (
    *("V.A.MESS.Z", "V.A.MEAS.ACS.VALUE.Z", "V.A.MEAS.PCS.VALUE.Z", "V.A.MOFFS.Z"),
    *("V.A.MEIN.Z", "V.A.MEIN.Z", "V.A.ABS.Z", "V.A.MEIN.Z", "V.A.ABS.Z"),
)
# PCS Z of ACS Z 55.5 at PCS X 150: z = 75 - x sin 15° + z' cos 15°
MESS_4 = (55.5 - 75 + 150 * math.sin(math.radians(15))) / math.cos(math.radians(15))
EXPECTED = {
    "meas1": (100, 100, 100, 80, 0, 80, 180, 0, 100),
    "meas2": (100, 100, 67, 47, 0, 47, 180, 0, 133),
    "meas3": (67, 100, 67, 47, 0, 47, 147, 0, 100),
    "meas4": (MESS_4, 55.5, MESS_4, MESS_4 + 10, 0, MESS_4 + 10, MESS_4 + 60, 0, 50),
}
LOST = "meas1 without the latch telegram of Z"


def _command(name: str) -> list[str]:
    program = name.partition(" ")[0]
    rig = "probe-xyz-55.toml" if program == "meas4" else "probe-xyz.toml"
    command = [sys.executable, "-m", "axisrig.bench.cli", "nc", str(PROGRAMS / f"{program}.nc")]
    command += ["--rig", str(RIGS / rig)]
    return [*command, "--set", "fault:drop=Z.TPDO2"] if name == LOST else command


@pytest.fixture(scope="module")
def runs() -> dict[str, subprocess.CompletedProcess[str]]:
    """All five command lines, side by side."""
    for model in MODELS:
        ensure_built(model)
    started = {
        name: subprocess.Popen(
            _command(name),
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        for name in (*EXPECTED, LOST)
    }
    finished = {}
    for name, process in started.items():
        out, err = process.communicate()
        finished[name] = subprocess.CompletedProcess(process.args, process.returncode, out, err)
    return finished


Runs = dict[str, subprocess.CompletedProcess[str]]


@pytest.mark.parametrize("program", EXPECTED)
def test_the_program_prints_what_the_manual_prints(runs: Runs, program: str) -> None:
    run = runs[program]
    # One line of progress at once, another one every 30 s
    assert [line for line in run.stderr.splitlines() if not line.startswith("running ")] == []
    assert run.returncode == 0
    assert run.stdout.endswith("\n")
    lines = run.stdout[:-1].split("\n")
    pairs = [line.split("=") for line in lines]
    assert [name for name, _ in pairs] == list(NAMES)
    assert all(re.fullmatch(r"\d+\.\d{6}", number) for _, number in pairs), lines
    values = [float(number) for _, number in pairs]
    assert values == pytest.approx(EXPECTED[program], rel=0, abs=TOLERANCE_MM)


@pytest.mark.parametrize("program", EXPECTED)
def test_values_that_no_encoder_rounds_are_exact(runs: Runs, program: str) -> None:
    """MEIN before G101 and after G102 is 0; ABS without it is the programmed position."""
    lines = runs[program].stdout.splitlines()
    exact = EXPECTED[program]
    assert lines[4] == lines[7] == "V.A.MEIN.Z=0.000000"
    assert lines[8] == f"V.A.ABS.Z={exact[8]:.6f}"


@pytest.mark.parametrize("program", EXPECTED)
def test_what_follows_from_one_measured_value_agrees_to_the_last_digit(
    runs: Runs, program: str
) -> None:
    """MOFFS, MEIN and ABS are MESS plus whole numbers, so all must carry the same error."""
    lines = runs[program].stdout.splitlines()
    values = [float(line.split("=")[1]) for line in lines]
    error = [value - exact for value, exact in zip(values, EXPECTED[program], strict=True)]
    for index in (2, 3, 5, 6):
        assert error[index] == pytest.approx(error[0], abs=1.01e-6)


def test_without_the_latch_telegram_no_value_is_printed(runs: Runs) -> None:
    run = runs[LOST]
    assert run.stdout == ""
    assert run.returncode == 1
    line = run.stderr.splitlines()[-1]
    assert line.startswith("ID 900006")
    assert "TPDO2" in line
