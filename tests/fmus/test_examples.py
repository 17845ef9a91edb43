"""The examples of the library against their reference results, and these against the equations.

`tests/fmus/validation/examples.py` integrates the equations without anything of the exporter; the
library holds what it has written (`AxisRig/Resources/ReferenceResults`).
"""

import csv
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from tests.small_fmus import small_fmu

from axisrig.fmus.build import LIBRARY

VALIDATION = Path(__file__).parent / "validation"
STORED = LIBRARY / "Resources" / "ReferenceResults"
REPRODUCED = 0.1  # share of the tolerance by which a reference made anew may differ
STEP_S = 50e-6  # internal step, that of the axes


def read(path: Path) -> list[dict[str, str]]:
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


SIGNALS = read(VALIDATION / "examples.csv")
EXAMPLES = tuple(dict.fromkeys(row["model"] for row in SIGNALS))


def rows_of(example: str) -> list[dict[str, str]]:
    return [row for row in SIGNALS if row["model"] == example]


@pytest.mark.long
@pytest.mark.parametrize("example", EXAMPLES)
def test_an_example_computes_its_reference(example, load):
    fmu = load(small_fmu(f"AxisRig.Examples.{example}", LIBRARY, STEP_S))
    wrong = []
    for row in read(STORED / f"{example}.csv"):
        instant = float(row["time"])
        if instant:
            fmu.step_to(instant)
        for signal in rows_of(example):
            name = signal["signal"]
            deviation = abs(fmu.get(name) - float(row[name]))
            if not deviation <= float(signal["tolerance"]):
                wrong.append(f"{name} at {instant:.6g} s is {deviation:.3g} off")
    assert not wrong, "\n".join(wrong[:20])


@pytest.mark.long
def test_the_references_are_those_of_the_equations(tmp_path):
    script = VALIDATION / "examples.py"
    subprocess.run([sys.executable, str(script), "--into", str(tmp_path)], check=True, timeout=300)
    for example in EXAMPLES:
        made, kept = read(tmp_path / f"{example}.csv"), read(STORED / f"{example}.csv")
        for signal in rows_of(example):
            columns = [[float(row[signal["signal"]]) for row in rows] for rows in (made, kept)]
            difference = np.abs(np.subtract(*columns)).max()
            assert difference <= REPRODUCED * float(signal["tolerance"]), signal


def alone(values: np.ndarray, tolerance: float) -> list[int]:
    """The places of values that are off their neighbours by more than ten times the tolerance.

    Such a one is off the cubic through two neighbours on each side (Lagrange: -1/6, 4/6, 4/6, -1/6)
    by an amount that comes back, 4/6 and 1/6 of it, where the neighbours are judged alike. What
    really bends, a contact or the end of a ramp, has another pattern.
    """
    off = np.zeros_like(values)
    off[2:-2] = values[2:-2] - (
        -values[:-4] + 4 * values[1:-3] + 4 * values[3:-1] - values[4:]
    ) / 6  # fmt: skip
    found = []
    for k in range(2, len(values) - 2):
        around = off[k - 2 : k + 3] / (off[k] or 1.0)
        is_off = abs(off[k]) > 10 * tolerance
        if is_off and np.abs(around - [1 / 6, -4 / 6, 1, -4 / 6, 1 / 6]).max() < 0.05:
            found.append(k)
    return found


@pytest.mark.parametrize("example", EXAMPLES)
def test_no_value_of_a_reference_stands_alone(example):
    """A slip in one place of a table: the whole one is made anew in the rest stage."""
    rows = read(STORED / f"{example}.csv")
    columns = {
        signal["signal"]: (
            np.array([float(row[signal["signal"]]) for row in rows]),
            float(signal["tolerance"]),
        )
        for signal in rows_of(example)
    }
    assert not [name for name, column in columns.items() if alone(*column)]
    slipped, tolerance = columns[rows_of(example)[0]["signal"]]
    slipped[20] += 0.01 * np.abs(slipped).max()
    assert alone(slipped, tolerance) == [20]


def test_every_model_that_runs_says_for_how_long():
    """`experiment` with stop, interval and tolerance; a reference covers all of it."""
    for file in sorted((LIBRARY / "Examples").glob("*.mo")):
        text = file.read_text(encoding="utf-8")
        if not re.search(r"^model ", text, re.M):
            continue
        found = re.search(
            r"experiment\(StopTime = (\S+), Interval = (\S+), Tolerance = \S+\)", text
        )
        assert found, file.name
        if file.stem in EXAMPLES:
            instants = [float(row["time"]) for row in read(STORED / f"{file.stem}.csv")]
            assert instants[-1] == pytest.approx(float(found[1]))
            assert instants[1] == pytest.approx(float(found[2]))
    assert {file.stem for file in STORED.glob("*.csv")} == set(EXAMPLES)
