"""This build beside that of another commit, both compiled: `python -m tests.perf.beside COMMIT`.

From the root of a checkout. The commit gets a checkout and an environment of its own below
`out/beside`, where they stay for the next time. The builds take turns; the median counts.
`--instructions` counts instructions by callgrind instead, for rows with equal frames.
"""

import argparse
import csv
import json
import os
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from statistics import median
from typing import NamedTuple

TABLE = Path(__file__).with_name("beside.csv")
FOLDER = Path("out/beside")
TURNS = 9
FIRST_S = 600.0
"""The longest that is waited for a first row."""


class Measure(NamedTuple):
    """A row of beside.csv. reach: how many times better than the other build it is to be."""

    name: str
    kind: str
    plan: str
    row: str
    better: str
    reach: float
    unit: str
    note: str

    def gain(self, mine: float, other: float) -> float:
        """Return how many times better the first of two values is."""
        return mine / other if self.better == "more" else other / mine


def read_measures() -> tuple[Measure, ...]:
    """Return the rows of beside.csv."""
    with TABLE.open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    return tuple(Measure(r.pop("measure"), reach=float(r.pop("reach")), **r) for r in rows)


class Build(NamedTuple):
    """A checkout with its compiled environment."""

    root: Path
    commit: str

    def words(self, *words: str) -> list[str]:
        """Return the command line of an axisrig command."""
        return [str(self.root / ".venv-fast/bin/axisrig"), *words]


def _git(*words: str, folder: Path = Path()) -> str:
    done = subprocess.run(["git", *words], cwd=folder, check=True, capture_output=True, text=True)
    return done.stdout.strip()


def build(commit: str | None) -> Build:
    """Compile a commit, or this checkout, unless it is compiled."""
    if commit is None:
        root, name = Path.cwd(), _git("rev-parse", "--short=12", "HEAD")
    else:
        name = _git("rev-parse", "--short=12", f"{commit}^{{commit}}")
        root = (FOLDER / name).absolute()
        if not root.exists():
            _git("worktree", "add", "--detach", str(root), name)
    print(f"compiling {name} in {root}", file=sys.stderr)
    subprocess.run(["make", "--quiet", "fast"], cwd=root, check=True, stdout=sys.stderr)
    return Build(root, name)


def _cpu_s(words: Sequence[str], root: Path) -> tuple[float, str]:
    """Return the CPU time of a command and of all that it started, s, and what it printed."""
    before = os.times()
    done = subprocess.run(words, cwd=root, check=True, capture_output=True, text=True)
    after = os.times()
    took_s = after.children_user + after.children_system
    return took_s - before.children_user - before.children_system, done.stdout


def _row(made: Build, measure: Measure) -> float:
    return float(_perf(made, measure)["cpu_factor"])


def _next(made: Build, measure: Measure) -> float:
    return float(_perf(made, measure)["next_row_ms"])


def _perf(made: Build, measure: Measure) -> dict[str, float]:
    plan = ["--plan", f"testplans/{measure.plan}", "--case", measure.row]
    found: dict[str, float] = json.loads(_cpu_s(made.words("perf", *plan, "--json"), made.root)[1])
    return found


def _scenarios(made: Build, measure: Measure) -> float:
    words = made.words("scenarios", "--seed", "1", "--count", measure.row)
    return int(measure.row) / _cpu_s(words, made.root)[0]


def many_rows(root: Path, count: int) -> Path:
    """Write a plan of so many rows, made of those of `latch_accuracy.csv`, and return it."""
    with (root / "testplans/latch_accuracy.csv").open(encoding="utf-8", newline="") as file:
        head, *rows = list(csv.reader(file))
    feed, first = head.index("plc:V.E.FEED"), head.index("case")
    path = root / "testplans/many-rows.csv"
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(head)
        for number in range(count):
            cells = list(rows[number % len(rows)])
            cells[first], cells[feed] = f"r{number}", f"{60 + number / 10:.1f}"
            writer.writerow(cells)
    return path


def _check(made: Build, measure: Measure) -> float:
    path = many_rows(made.root, int(measure.row))
    try:
        return _cpu_s(made.words("check", str(path)), made.root)[0]
    finally:
        path.unlink()


def _first_row(made: Build, count: int) -> tuple[float, float]:
    """Return the wall time to the first recording, s, and the leader's peak memory then, MB."""
    path = many_rows(made.root, count)
    with tempfile.TemporaryDirectory() as folder:
        words = made.words("run", str(path), "-j", "2", "-o", f"{folder}/out")
        began_s = time.monotonic()
        process = subprocess.Popen(
            words, cwd=made.root, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        )
        try:
            while not any(Path(folder, "out/traces").glob("*")):
                if process.poll() is not None or time.monotonic() > began_s + FIRST_S:
                    raise SystemExit(f"no row of {path} ran")
                time.sleep(0.01)
            took_s = time.monotonic() - began_s
            status = Path(f"/proc/{process.pid}/status").read_text(encoding="ascii")
            return took_s, int(status.partition("VmHWM:")[2].split()[0]) / 1024
        finally:
            process.send_signal(signal.SIGINT)
            process.wait()
            path.unlink()


KINDS: dict[str, Callable[[Build, Measure], float]] = {
    "row": _row,
    "next": _next,
    "scenarios": _scenarios,
    "check": _check,
    "first": lambda made, measure: _first_row(made, int(measure.row))[0],
    "memory": lambda made, measure: _first_row(made, int(measure.row))[1],
}

_ONE_RUN = """
import os, subprocess, sys
from pathlib import Path
from axisrig.bench.campaign.results.writer import RunFiles
from axisrig.bench.campaign.runner import run_case
from axisrig.bench.plan.plan import read_plan
(case,) = [c for c in read_plan(Path(sys.argv[1])).cases if c.case == sys.argv[2]]
run_case(case, RunFiles())
for turn in ("on", "off"):
    if turn == "off":
        print(run_case(case, RunFiles()).frame_log_sha256)
    subprocess.run(["callgrind_control", "-i", turn, str(os.getpid())], stdout=sys.stderr)
"""


def instructions(made: Build, measure: Measure) -> tuple[int, str]:
    """Return the instructions of a second run in one process, and its hash of the frames."""
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder, "callgrind")
        valgrind = ["valgrind", "--tool=callgrind", "--instr-atstart=no"]
        python = str(made.root / ".venv-fast/bin/python")
        words = [python, "-c", _ONE_RUN, f"testplans/{measure.plan}", measure.row]
        text = _cpu_s([*valgrind, f"--callgrind-out-file={out}", *words], made.root)[1]
        totals = [
            int(line.partition(":")[2])
            for file in Path(folder).glob("callgrind*")
            for line in file.read_text(encoding="utf-8", errors="replace").splitlines()
            if line.startswith("totals:")
        ]
    return max(totals), text.strip()


def _turns(measures: Sequence[Measure], builds: Sequence[Build], turns: int) -> list[list[float]]:
    """Return the medians of each measure, this build's first."""
    found: list[list[list[float]]] = [[[] for _ in builds] for _ in measures]
    for turn in range(turns):
        for measure, values in zip(measures, found, strict=True):
            print(f"{turn + 1}/{turns} {measure.name}", file=sys.stderr)
            for number in (0, 1) if turn % 2 else (1, 0):
                values[number].append(KINDS[measure.kind](builds[number], measure))
    return [[median(values) for values in of_measure] for of_measure in found]


def report(arguments: Sequence[str] | None = None) -> str:
    """Compile, measure, and return a table."""
    parser = argparse.ArgumentParser(prog="python -m tests.perf.beside", description=__doc__)
    parser.add_argument("commit", help="the other commit, as git has it")
    parser.add_argument("-k", dest="only", default="", help="measures with this in name or kind")
    parser.add_argument("--turns", type=int, default=TURNS)
    parser.add_argument("--instructions", action="store_true", help="count instructions of rows")
    words = parser.parse_args(arguments)
    measures = [m for m in read_measures() if words.only in f"{m.name} {m.kind}"]
    mine, other = builds = (build(None), build(words.commit))
    lines = []
    if words.instructions:
        lines.append("| measure | instructions | those of the other | ratio | frames |")
        lines.append("|---|---|---|---|---|")
        for measure in (m for m in measures if m.kind == "row"):
            (count, frames), (count_0, frames_0) = (instructions(made, measure) for made in builds)
            same = "equal" if frames == frames_0 else "differ"
            name = f"{measure.name} ({measure.row})"
            lines.append(f"| {name} | {count} | {count_0} | {count / count_0:.3f} | {same} |")
    else:
        lines.append(f"| measure | {mine.commit} | {other.commit} | unit | better | to reach |")
        lines.append("|---|---|---|---|---|---|")
        medians = _turns(measures, builds, words.turns)
        for measure, (value, value_0) in zip(measures, medians, strict=True):
            gain = f"{measure.gain(value, value_0):.2f} times"
            cells = (measure.name, f"{value:.4g}", f"{value_0:.4g}", measure.unit, gain)
            lines.append(f"| {' | '.join(cells)} | {measure.reach:g} |")
    return "\n".join(lines)


if __name__ == "__main__":
    print(report())
