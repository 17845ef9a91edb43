"""Drives in a process of their own, and what tests ask of both sides.

Both run in real time on whatever machine this is, so values are asserted and no times: the drives'
time goes on by SYNC, and the published latch is compared with the truth that the drives wrote down.
"""

import csv
import shutil
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

ROOT = Path(__file__).parents[3]
RIG = ROOT / "testplans" / "rigs" / "probe-z.toml"
PLAN = ROOT / "testplans" / "latch_accuracy.csv"
LIMIT_S = 120.0
INCREMENTS_PER_MM = 1_048_576 / 10.0


class Drives:
    """`axisrig drive` in a process of its own; `lines` are what it has printed."""

    def __init__(self, folder: Path, *words: str, rig: Path = RIG) -> None:
        self.folder = folder
        command = [
            sys.executable,
            "-m",
            "axisrig.bench.cli",
            "drive",
            str(rig),
            "-o",
            str(folder),
            *words,
        ]
        self.process = subprocess.Popen(
            command, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
        )
        self.lines: list[str] = []

    def wait_for(self, text: str) -> str:
        """Read on until a line holds the text."""
        assert self.process.stdout is not None
        for line in self.process.stdout:
            self.lines.append(line)
            if text in line:
                return line
        raise AssertionError(f"no {text!r} in {self.lines}, {self.process.communicate()[1]}")

    def stop(self) -> None:
        """Press Ctrl-C, once."""
        self.process.terminate()
        out, err = self.process.communicate(timeout=LIMIT_S)
        self.lines += out.splitlines()
        assert self.process.returncode == 0, err

    def latches(self) -> list[dict[str, str]]:
        with (self.folder / "latches.csv").open(encoding="utf-8", newline="") as file:
            return list(csv.DictReader(file))


@contextmanager
def drives_at(folder: Path, *words: str, rig: Path = RIG) -> Iterator[Drives]:
    made = Drives(folder, *words, rig=rig)
    try:
        yield made
    finally:
        if made.process.poll() is None:
            made.process.kill()
            made.process.communicate()


def axisrig(*words: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "axisrig.bench.cli", *words]
    return subprocess.run(
        command, cwd=ROOT, capture_output=True, text=True, timeout=LIMIT_S, check=False
    )


def serving(drives: Drives) -> tuple[str, str]:
    """Return host and port that the drives serve."""
    line = drives.wait_for("socketcand server on")
    drives.wait_for("axis Z")
    host, _, port = line.split()[-1].rpartition(":")
    return host, port


def socketcand(drives: Drives) -> list[str]:
    host, port = serving(drives)
    options = ["--option", f"host={host}", "--option", f"port={port}"]
    return ["--interface", "socketcand", "--channel", "can0", *options]


def rows(folder: Path, name: str) -> list[dict[str, str]]:
    with (folder / name).open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def patient_plan(folder: Path) -> Path:
    """Copy the plans; cycle and drive wait long for each other, for this machine may be busy."""
    for name in ("rigs", "programs"):
        shutil.copytree(PLAN.parent / name, folder / name)
    rig = folder / "rigs" / RIG.name
    text = rig.read_text(encoding="utf-8").replace(
        "[drive.servo]\n", "[drive.servo]\nrpdo_timeout_ms = 10000\n"
    )
    rig.write_text(f"{text}\n[realtime]\nwait_ms = 1000\n", encoding="utf-8")
    return Path(shutil.copy(PLAN, folder))
