"""FMUs to hand on: each with reference results, options, inputs and checksums beside it.

Source: FMI cross-check rules (folders and names of files), github.com/modelica/fmi-cross-check.
"""

import csv
import hashlib
import importlib.metadata
import shutil
from collections import deque
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cache
from itertools import groupby
from pathlib import Path
from typing import NamedTuple

from fmpy.model_description import ModelVariable

from axisrig.bench.tools.fmu.library import build_models, chosen_platforms
from axisrig.fmus import PLATFORMS, ensure_built, this_platform
from axisrig.kernel.cosim.fmi.fmu import Exchange, FmuSlave, load_description, load_fmu
from axisrig.kernel.time.clock import TimeNs, seconds_to_ns

COURSES_FILE = Path(__file__).parent / "courses.csv"
SUMS = "SHA256SUMS"
# Where a description leaves one out (that of OpenModelica may)
EXPERIMENT = {"startTime": 0.0, "stopTime": 1.0, "stepSize": 1e-3, "tolerance": 1e-9}


class Change(NamedTuple):
    """From `at_s` on an input has the value; 0: it is its start value."""

    at_s: float
    variable: str
    value: float


@cache
def courses() -> Mapping[str, Sequence[Change]]:
    """What moves each model of the library, by its full name, in the order of time.

    Most inputs stay as they are from the start on: any importer can set them as start values.
    """
    found: dict[str, list[Change]] = {}
    with COURSES_FILE.open(encoding="utf-8", newline="") as file:
        for row in csv.DictReader(file):
            change = Change(float(row["at_s"]), row["variable"], float(row["value"]))
            found.setdefault(row["model"], []).append(change)
    return {model: sorted(changes) for model, changes in found.items()}


def walk(
    path: Path, course: Sequence[Change], step_ns: TimeNs, count: int
) -> tuple[list[str], list[list[float]]]:
    """Step an FMU as the bench does; return names and values, the time in s first.

    course: in the order of time; a change acts from the first communication point that is not
    before it. Arrays are left out. Values of Boolean and whole outputs are numbers.
    Raises UserError and PlantError as `load_fmu` and its instance.
    """
    slave = load_fmu(path, "reference")
    waiting = deque(course)
    try:
        _apply(slave, waiting, 0)
        slave.initialize(0)
        readers = _readers(slave)
        names = [name for _, part in readers for name in part]
        rows = [_row(0.0, readers)]
        for k in range(1, count + 1):
            _apply(slave, waiting, (k - 1) * step_ns)
            slave.step_to(k * step_ns)
            rows.append(_row(k * step_ns * 1e-9, readers))
    finally:
        slave.close()
    return ["time", *names], rows


def _apply(slave: FmuSlave, waiting: deque[Change], time_ns: TimeNs) -> None:
    """Set what has its time now or had it before."""
    while waiting and seconds_to_ns(waiting[0].at_s) <= time_ns:
        _, name, value = waiting.popleft()
        slave.set_start(name, _typed(slave.variable(name), value))


def _readers(slave: FmuSlave) -> list[tuple[Exchange, list[str]]]:
    """Outputs by type."""
    kinds: dict[str, list[str]] = {}
    for name in slave.names("output"):
        variable = slave.variable(name)
        if not variable.dimensions:
            kinds.setdefault(str(variable.type), []).append(name)
    return [(Exchange(slave, names), names) for names in kinds.values()]


def _row(time_s: float, readers: Sequence[tuple[Exchange, list[str]]]) -> list[float]:
    row = [time_s]
    for exchange, _ in readers:
        exchange.read()
        row += [float(value) for value in exchange.values]
    return row


def release(
    folder: Path, model: str, fmi: str, platforms: Sequence[str], fmu: Path, *, runs_here: bool
) -> Path:
    """Put an FMU into a release folder with what belongs beside it; return its new path.

    folder: of the release. platforms: that it was built for. runs_here: this platform is one of
    them; otherwise the reference results come from the same model built for this one.
    """
    name = model.rpartition(".")[2]
    version = importlib.metadata.version("axisrig")
    everywhere = {platform.name for platform in PLATFORMS.values() if platform.in_all}
    built_for = "all" if set(platforms) == everywhere else "+".join(platforms)
    place = folder / fmi / "cs" / built_for / "axisrig" / version / name
    place.mkdir(parents=True, exist_ok=True)
    released = place / f"{name}.fmu"
    shutil.copyfile(fmu, released)
    path = released if runs_here else ensure_built(model, fmi=fmi)
    description, _ = load_description(path)
    start_s, stop_s, step_s, tolerance = (
        float(getattr(description.defaultExperiment, word, None) or default)
        for word, default in EXPERIMENT.items()
    )
    step_ns = seconds_to_ns(step_s)
    count = seconds_to_ns(stop_s - start_s) // step_ns
    course = courses().get(model, ())
    names, rows = walk(path, course, step_ns, count)
    _write_csv(place / f"{name}_ref.csv", names, rows)
    inputs = [v for v in description.modelVariables if v.causality == "input"]
    _write_csv(
        place / f"{name}_in.csv",
        ["time", *(variable.name for variable in inputs)],
        _input_rows(inputs, course, start_s, stop_s),
    )
    options = {
        "StartTime": start_s,
        "StopTime": stop_s,
        "StepSize": step_ns * 1e-9,
        "RelTol": tolerance,
    }
    text = "".join(f"{word}, {value!r}\n" for word, value in options.items())
    (place / f"{name}_ref.opt").write_text(text, encoding="utf-8", newline="\n")
    return released


def _input_rows(
    inputs: Sequence[ModelVariable], course: Sequence[Change], start_s: float, stop_s: float
) -> Iterator[list[float]]:
    """Time and values of the inputs: at the start, before and after each change, at the end."""
    values = {variable.name: _typed(variable, None) for variable in inputs}
    kinds = {variable.name: variable for variable in inputs}
    groups = groupby(course, key=lambda change: max(change.at_s, start_s))
    if not course or course[0].at_s > start_s:
        yield [start_s, *values.values()]
    for at_s, changes in groups:
        if at_s > start_s:
            yield [at_s, *values.values()]
        values |= {name: _typed(kinds[name], value) for _, name, value in changes}
        yield [at_s, *values.values()]
    yield [stop_s, *values.values()]


def _typed(variable: ModelVariable, value: float | None) -> float:
    """A value, or the start value, as a number of the variable's type; truth values are 0 and 1."""
    words = {"true": "1", "false": "0"}
    number = float(words.get(variable.start, variable.start)) if value is None else value
    return number if str(variable.type) in ("Real", "Float64") else int(number)


def _write_csv(path: Path, names: Sequence[str], rows: Iterable[Sequence[float]]) -> None:
    """Write values so that the same numbers are read back."""
    with path.open("w", encoding="utf-8", newline="\n") as file:
        file.write(",".join(f'"{name}"' for name in names) + "\n")
        file.writelines(",".join(map(repr, row)) + "\n" for row in rows)


def write_sums(folder: Path) -> Path:
    """Write the checksums of all files of a release as `sha256sum -c` reads them."""
    path = folder / SUMS
    text = "".join(f"{digest}  {name}\n" for name, digest in _sums(folder))
    path.write_text(text, encoding="utf-8", newline="\n")
    return path


def _sums(folder: Path) -> Iterator[tuple[str, str]]:
    for path in sorted(folder.rglob("*")):
        if path.is_file() and path.name != SUMS:
            with path.open("rb") as file:
                digest = hashlib.file_digest(file, "sha256").hexdigest()
            yield path.relative_to(folder).as_posix(), digest


def release_models(
    folder: Path,
    model: str | None,
    fmi: Sequence[str],
    platforms: Sequence[str] = (),
    compiler: str | None = None,
) -> Iterator[Path]:
    """Build models, put them into a release folder, and yield each path; the checksums come last.

    Arguments and errors as `build_models`.
    """
    here = this_platform().name
    names = chosen_platforms(platforms) or [here]
    for built in build_models(model, fmi, platforms, compiler):
        runs_here = here in names
        yield release(folder, built.model, built.fmi, names, built.path, runs_here=runs_here)
    yield write_sums(folder)
