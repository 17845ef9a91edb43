"""docs/distance-control.md: its tables and numbers against their sources and formulas."""

import csv
import math
import re
from pathlib import Path

import pytest

from axisrig.kernel.distance import DistanceCommand, DistanceState

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "distance-control.md").read_text(encoding="utf-8")


def table_behind(words: str) -> list[list[str]]:
    """Rows of the first table behind some words, its head first."""
    lines = PAGE.split(words, 1)[1].splitlines()
    begin = next(i for i, line in enumerate(lines) if line.startswith("|"))
    rows = []
    for line in lines[begin:]:
        if not line.startswith("|"):
            break
        rows.append([cell.strip() for cell in re.split(r"(?<!\\)\|", line)[1:-1]])
    return [rows[0], *rows[2:]]


def test_states_are_those_of_the_table() -> None:
    head, *rows = table_behind("## States")
    commands = [DistanceCommand[cell.partition(" ")[0]] for cell in head[1:]]
    assert [f"({int(c)})" for c in commands] == [cell.partition(" ")[2] for cell in head[1:]]
    shown = {}
    for first, *cells in rows:
        number, name = first.split()
        assert DistanceState[name] == int(number)
        for command, cell in zip(commands, cells, strict=True):
            shown[name, command.name] = cell
    path = ROOT / "kernel" / "axisrig" / "kernel" / "distance" / "states.csv"
    with path.open(encoding="utf-8", newline="") as file:
        table = list(csv.DictReader(file))
    assert len(table) == len(shown)
    for row in table:
        cell = shown[row["state"], row["command"]]
        if row["next"]:
            assert int(cell[0]) == DistanceState[row["next"]]
        else:
            assert cell.startswith("refused")
            assert ("70334" in cell) == (row["alarm"] == "70334")


def mean_limit(count: int, dead: int) -> float:
    """2N sin^2(w/2)/sin(Nw/2), w = pi/(N + 2n); one value: 2 sin(pi/(2(2n + 1)))."""
    if count == 1:
        return 2 * math.sin(math.pi / (2 * (2 * dead + 1)))
    omega = math.pi / (count + 2 * dead)
    return 2 * count * math.sin(omega / 2) ** 2 / math.sin(count * omega / 2)


def test_limits_of_kp_are_those_of_the_formulas() -> None:
    head, *rows = table_behind("CONST_DIST is stable below")
    counts = [1, *(int(re.findall(r"\d+", cell)[0]) for cell in head[2:5])]
    assert counts == [1, 4, 10, 20]
    for first, *cells in rows:
        dead = int(first)
        shown = [float(cell) for cell in cells]
        assert shown[:4] == pytest.approx([mean_limit(n, dead) for n in counts], abs=5e-4)
        # Without overshoot: n^n/(n + 1)^(n + 1)
        assert shown[4] == pytest.approx(dead**dead / (dead + 1) ** (dead + 1), abs=5e-4)


def test_the_overshoot_behind_clamps() -> None:
    """v^2/2a - v/K + a/2K^2 for 10 mm/s, 100 mm/s2, kp 0.3, 1 ms."""
    speed, acceleration, gain = 10.0, 100.0, 0.3 / 1e-3
    value = speed**2 / (2 * acceleration) - speed / gain + acceleration / (2 * gain**2)
    assert f"{value:.2f} mm" == "0.47 mm"
    assert "10 mm/s, 100 mm/s², kp 0.3 and 1 ms give 0.47 mm" in " ".join(PAGE.split())


def test_the_errors_on_a_ramp() -> None:
    """v T/kp, and v (T/kp + n T + (N - 1)/2 T) in surface mode; 10 mm/s, 1 ms, kp 0.2, N 4, n 1."""
    speed, cycle, kp = 10.0, 1e-3, 0.2
    text = " ".join(PAGE.split())
    assert f"kp 0.2: {speed * cycle / kp * 1e3:.0f} um in distance mode" in text
    surface = speed * cycle * (1 / kp + 1 + 1.5) * 1e3
    assert f"with N 4 and n 1 {surface:.0f} um in surface mode" in text
    assert f"which is {2 / (1 + 2 * 0.01 / cycle):.3f} for Tv 0.01 s at 1 ms" in text
