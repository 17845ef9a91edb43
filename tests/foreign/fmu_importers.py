"""Importers of FMUs that nobody here wrote: each gives the outputs at every communication point.

- fmpy (a dependency of axisrig): `simulate_fmu`, a master and reader of its own
- fmusim: AXISRIG_FMUSIM=<program>, or on the PATH. Its source was in the folder `fmusim` of
  github.com/modelica/Reference-FMUs up to v0.0.39; Debian: libxml2-dev, libsundials-dev,
  libminizip-dev
- ecos: `pip install ecospy==0.7.2`, into this environment or another whose python is
  AXISRIG_ECOSPY; Debian: libtbb12
- libcosim: `pip install libcosimpy==0.0.6`, likewise with AXISRIG_LIBCOSIMPY; FMI 2.0 only
"""

import json
import os
import shutil
import subprocess
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import fmpy
import numpy as np
import pytest
from fmpy.util import read_csv
from numpy.typing import NDArray

from axisrig.bench.tools.fmu.release import Change

PROGRAMS = {
    "ecospy": Path(__file__).parent / "ecos_steps.py",
    "libcosimpy": Path(__file__).parent / "libcosim_steps.py",
}


@dataclass(frozen=True)
class Task:
    """What to run: an FMU on a course, so many steps. outputs: name and type of each to read."""

    fmu: Path
    course: Sequence[Change]
    step_ns: int
    count: int
    outputs: Sequence[tuple[str, str]]

    @property
    def step_s(self) -> float:
        return self.step_ns / 1e9

    @property
    def stop_s(self) -> float:
        return self.count * self.step_ns / 1e9

    def starts(self) -> dict[str, float]:
        return {change.variable: change.value for change in self.course if change.at_s == 0}

    def changes(self) -> list[Change]:
        return [change for change in self.course if change.at_s > 0]


def _inputs(task: Task) -> NDArray[np.void] | None:
    """The inputs that change during the run, before and after each instant; None without."""
    changes = task.changes()
    if not changes:
        return None
    names = list(dict.fromkeys(change.variable for change in changes))
    values = dict.fromkeys(names, 0.0)
    rows = [(0.0, *values.values())]
    for at_s in dict.fromkeys(change.at_s for change in changes):
        rows.append((at_s, *values.values()))
        values |= {c.variable: c.value for c in changes if c.at_s == at_s}
        rows.append((at_s, *values.values()))
    rows.append((task.stop_s, *values.values()))
    return np.array(rows, dtype=[(name, np.float64) for name in ("time", *names)])


def by_fmpy(task: Task, folder: Path) -> NDArray[np.float64]:
    del folder
    found = fmpy.simulate_fmu(
        str(task.fmu),
        stop_time=task.stop_s,
        step_size=task.step_s,
        output_interval=task.step_s,
        start_values=task.starts(),
        input=_inputs(task),
        output=[name for name, _ in task.outputs],
        fmi_type="CoSimulation",
    )
    return np.column_stack([found[name].astype(float) for name, _ in task.outputs])


def by_fmusim(task: Task, folder: Path) -> NDArray[np.float64]:
    program = os.environ.get("AXISRIG_FMUSIM") or shutil.which("fmusim")
    if program is None:
        pytest.skip("fmusim is missing, see tests/foreign/fmu_importers.py")
    out = folder / "out.csv"
    command = [program, "--output-interval", repr(task.step_s), "--stop-time", repr(task.stop_s)]
    command += ["--output-file", str(out)]
    for name, value in task.starts().items():
        command += ["--start-value", name, f"{value:.17g}"]
    inputs = _inputs(task)
    if inputs is not None:
        rows = [",".join(f"{value:.17g}" for value in row) for row in inputs]
        text = "\n".join([",".join(f'"{name}"' for name in inputs.dtype.names or ()), *rows])
        (folder / "in.csv").write_text(text + "\n", encoding="utf-8")
        command += ["--input-file", str(folder / "in.csv")]
    for name, _ in task.outputs:
        command += ["--output-variable", name]
    done = subprocess.run([*command, str(task.fmu)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    found = read_csv(str(out))
    return np.column_stack([found[name] for name, _ in task.outputs])


def by_ecos(task: Task, folder: Path) -> NDArray[np.float64]:
    del folder
    return _by_program("ecospy", "AXISRIG_ECOSPY", task)


def by_libcosim(task: Task, folder: Path) -> NDArray[np.float64]:
    del folder
    if fmpy.read_model_description(str(task.fmu)).fmiVersion != "2.0":
        pytest.skip("libcosim takes FMI 1.0 and 2.0 only")
    return _by_program("libcosimpy", "AXISRIG_LIBCOSIMPY", task)


@cache
def _is_there(python: str, package: str) -> bool:
    asked = subprocess.run([python, "-c", f"import {package}"], capture_output=True, check=False)
    return asked.returncode == 0


def _by_program(package: str, place: str, task: Task) -> NDArray[np.float64]:
    """Run the program of a package; place: the variable that may name another python."""
    python = os.environ.get(place) or sys.executable
    if not _is_there(python, package):
        pytest.skip(f"{package} is missing, see tests/foreign/fmu_importers.py")
    words = {"Real": "real", "Float64": "real", "Boolean": "bool", "Integer": "int", "Int32": "int"}
    kinds = {v.name: v.type for v in fmpy.read_model_description(str(task.fmu)).modelVariables}
    job = {
        "fmu": str(task.fmu),
        "step_s": task.step_s,
        "step_ns": task.step_ns,
        "count": task.count,
        "start": [[n, words[kinds[n]], value] for n, value in task.starts().items()],
        "changes": [
            [round(c.at_s * 1e9 / task.step_ns), c.variable, words[kinds[c.variable]], c.value]
            for c in task.changes()
        ],
        "outputs": [[name, words[kind]] for name, kind in task.outputs],
    }
    done = subprocess.run(
        [python, str(PROGRAMS[package])], input=json.dumps(job), capture_output=True, text=True,
        check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr
    (line,) = (line for line in done.stdout.splitlines() if line.startswith("[["))
    return np.array(json.loads(line), dtype=float)


@dataclass(frozen=True)
class Importer:
    """run: gives rows at 0 (unless begins is False) and after each step.

    digits: of its numbers; 0: it gives every bit.
    """

    run: Callable[[Task, Path], NDArray[np.float64]]
    digits: int = 0
    begins: bool = True


IMPORTERS = {
    "fmpy": Importer(by_fmpy),
    "fmusim": Importer(by_fmusim, digits=16),
    "ecos": Importer(by_ecos),
    "libcosim": Importer(by_libcosim, begins=False),
}
