"""Every component of the library against a reference that does not come from the exporter."""

import ast
import csv
import os
import re
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fmpy import fmi3
from tests.small_fmus import small_fmu

from axisrig.fmus.build import CATALOGUE, LIBRARY, build, cache_key, place_in_cache

VALIDATION = Path(__file__).parent / "validation"
STEP_S = 50e-6  # internal step of the validation models of parts
# The validation of a model that is an FMU itself has its internal step.
STEPS_S = {name.rpartition(".")[2]: row.step_s for name, row in CATALOGUE.items()}
# A reference made anew may differ by this share of the tolerance: mathematical libraries round
# differently from processor to processor, and every impact of a contact carries that on. What is
# left is a twentieth of what an FMU is judged by.
REPRODUCED = 0.05
# The matrices of the references are small: threads would only wait for each other.
ONE_THREAD = {**os.environ, "OPENBLAS_NUM_THREADS": "1"}
# What a reference may be made from.
ALLOWED = {*sys.stdlib_module_names, "numpy", "scipy"}
ALLOWED |= {path.stem for path in VALIDATION.glob("*.py")}


def read(name: str) -> list[dict[str, str]]:
    with (VALIDATION / name).open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


SIGNALS = read("signals.csv")
MODELS = tuple(dict.fromkeys(row["model"] for row in SIGNALS))
# They look at 72 points of a workpiece: to build one takes 20 s, and their parts are models too.
LARGE = ("HeadDistanceSensor", "RobotDistanceSensor")
# Between them they use nearly every component of the library: they are in the quick stage.
WHOLE = (
    *("WorkpieceProbe", "GantryPair", "HeadTouchProbe", "SampledServoAxis", "DistanceSensor"),
    *("TiltingSlide", "DigitalInput", "RotaryAxis", "GravityAxis", "SixJointRobot"),
    *("SecondEncoder", "ScrewAxis"),
)


def stored(model: str, folder: Path = VALIDATION / "references") -> dict[str, np.ndarray]:
    """The columns of a reference by name."""
    with (folder / f"{model}.csv").open(encoding="utf-8", newline="") as file:
        names, *rows = csv.reader(file)
    return dict(zip(names, np.array(rows, dtype=float).T, strict=True))


def rows_of(model: str) -> list[dict[str, str]]:
    return [row for row in SIGNALS if row["model"] == model]


class Beside:
    """An instance beside its reference; its calls are prepared once, since it makes many."""

    def __init__(self, fmu, model: str) -> None:
        self.fmu = fmu
        reference = stored(model)
        self._instants = reference["time_s"].tolist()
        self._signals, self._get, columns, tolerances = [], [], [], []
        types = {v.name: (v.type, v.valueReference) for v in fmu.description.modelVariables}
        for kind in sorted({types[row["signal"]][0] for row in rows_of(model)}):
            rows = [row for row in rows_of(model) if types[row["signal"]][0] == kind]
            references = (fmi3.fmi3ValueReference * len(rows))(
                *(types[row["signal"]][1] for row in rows)
            )
            values = (getattr(fmi3, f"fmi3{kind}") * len(rows))()
            call = getattr(fmu.slave, f"fmi3Get{kind}")
            held = (fmu.slave.component, references, len(rows), values, len(rows))
            self._get.append((call, held, values))
            self._signals += [row["signal"] for row in rows]
            columns += [reference[row["signal"]] for row in rows]
            tolerances += [float(row["tolerance"]) for row in rows]
        self._expected = np.array(columns).T.tolist()
        self._tolerances = tolerances

    def deviations(self) -> Iterator[tuple[float, str, float]]:
        """Instant, signal and deviation over tolerance, one instant after the other.

        The deviation of what is not a number is not a number.
        """
        for k, (instant, expected) in enumerate(zip(self._instants, self._expected, strict=True)):
            if k:
                self.fmu.step_to(instant)
            found: list[float] = []
            for call, held, values in self._get:
                call(*held)
                found += values
            for name, value, wanted, tolerance in zip(
                self._signals, found, expected, self._tolerances, strict=True
            ):
                yield instant, name, abs(value - wanted) / tolerance


def built(model: str, is_optimised: bool) -> Path:
    """The FMU from a cache; its name holds a hash of all that it is made from.

    Those that are judged by their tolerances are built as users get them, into the user's cache.
    """
    name, step_s = f"AxisRig.Validation.{model}", STEPS_S.get(model, STEP_S)
    if not is_optimised:
        return small_fmu(name, LIBRARY, step_s)
    key = cache_key(name, step_s=step_s)
    path = place_in_cache(next(iter(CATALOGUE))).with_name(f"Validation.{model}-{key[:24]}.fmu")
    return path if path.is_file() else build(name, path, step_s=step_s)


@pytest.fixture(scope="session")
def validation(load) -> Callable[..., Beside]:
    """One instance of each validation model, kept for the session."""
    loaded: dict[tuple[str, bool], Beside] = {}

    def get(model: str, is_optimised: bool = False) -> Beside:
        key = model, is_optimised
        if key not in loaded:
            loaded[key] = Beside(load(built(model, is_optimised)), model)
        else:
            loaded[key].fmu.restart()
        return loaded[key]

    return get


@pytest.mark.long(but=1)
@pytest.mark.parametrize("model", MODELS)
def test_model_is_within_its_tolerances(model, validation):
    outside = [
        f"{signal} at {instant:.6g} s: {ratio:.3g} times the tolerance"
        for instant, signal, ratio in validation(model, is_optimised=True).deviations()
        if not ratio <= 1
    ]
    assert not outside, "\n".join(outside[:20])


@pytest.mark.parametrize(
    "model",
    [
        model if model in WHOLE else pytest.param(model, marks=pytest.mark.long)
        for model in MODELS
        if model not in LARGE
    ],
)
def test_model_without_optimisation_is_within_its_tolerances(model, validation):
    """In a hundredth of the time: these builds are there for the other tests."""
    outside = [found for found in validation(model).deviations() if not found[2] <= 1]
    assert not outside, outside[:3]


TRUTH = {"true": 1.0, "false": 0.0}


def parameters(fmu, model: str) -> dict[str, tuple[Any, list[float]]]:
    """The parameters that a validation model must notice: as described, and their values."""
    spared = {row["parameter"] for row in read("not_physical.csv") if row["model"] == model}
    found = {v.name: v for v in fmu.description.modelVariables if v.causality == "parameter"}
    assert spared <= set(found), "not_physical.csv names what is not there"
    return {
        name: (v, [TRUTH[e] if e in TRUTH else float(e) for e in v.start.split()])
        for name, v in found.items()
        if name not in spared
    }


def changed(variable, value: float) -> float | int | bool:
    """1 % more, of whole numbers at least one; the other truth value; the other direction."""
    if variable.type == "Float64":
        return 1.01 * value
    if variable.type == "Boolean":
        return not value
    number = int(value)
    if "direction" in variable.name:
        return -number
    step = max(1, abs(number) // 100)
    return number + step if number + step <= int(variable.max or sys.maxsize) else number - step


@pytest.mark.parametrize(
    "model", [pytest.param(m, marks=pytest.mark.long) if m in LARGE else m for m in MODELS]
)
@pytest.mark.long
def test_one_percent_of_any_physical_parameter_is_noticed(model, validation):
    """A value that is no number any more does not count: something broke, nothing was noticed."""
    beside = validation(model)
    unnoticed = []
    for name, (variable, elements) in parameters(beside.fmu, model).items():
        for k, value in enumerate(elements):
            if value or variable.type != "Float64":
                other = [*elements[:k], changed(variable, value), *elements[k + 1 :]]
                beside.fmu.restart(**{name: other})
                if not any(1 < ratio < np.inf for _, _, ratio in beside.deviations()):
                    unnoticed.append(f"{name}, element {k} = {value!r}")
    assert not unnoticed, unnoticed


@pytest.mark.long
def test_a_parameter_that_is_zero_in_one_model_is_a_number_in_another(validation):
    """Zero has no percent, so that another model with the same component must notice it."""
    values: dict[str, set[float]] = {}
    for model in (model for model in MODELS if model not in LARGE):
        for name, (variable, value) in parameters(validation(model).fmu, model).items():
            if variable.type == "Float64":
                values.setdefault(name.rpartition(".")[2], set()).update(value)
    assert not {name for name, found in values.items() if found == {0.0}}


@pytest.mark.long
def test_stored_references_are_those_that_the_scripts_make(tmp_path):
    command = [sys.executable, str(VALIDATION / "make_references.py"), "--into", str(tmp_path)]
    shares = [MODELS[k::2] for k in (0, 1)]
    running = [subprocess.Popen([*command, *share], env=ONE_THREAD) for share in shares]
    assert [process.wait(timeout=300) for process in running] == [0, 0]
    assert {p.name for p in (VALIDATION / "references").iterdir()} == {f"{m}.csv" for m in MODELS}
    for model in MODELS:
        made, kept = stored(model, tmp_path), stored(model)
        assert list(made) == list(kept)
        assert np.array_equal(made["time_s"], kept["time_s"])
        for row in rows_of(model):
            difference = np.abs(made[row["signal"]] - kept[row["signal"]]).max()
            assert difference <= REPRODUCED * float(row["tolerance"]), row


@pytest.mark.parametrize("script", sorted(VALIDATION.glob("*.py")), ids=lambda p: p.name)
def test_a_reference_is_made_without_the_exporter(script: Path):
    """Only numpy, scipy, the standard library and the modules beside it."""
    tree = ast.parse(script.read_text(encoding="utf-8"))
    imported = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            imported |= {alias.name.split(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            imported.add(node.module.split(".")[0])
    assert imported <= ALLOWED


def test_every_signal_names_unit_tolerance_and_source():
    for row in SIGNALS:
        assert all(row.values()), row
        assert float(row["tolerance"]) > 0, row


def test_every_validation_model_is_compared():
    models = {p.stem for p in (LIBRARY / "Validation").glob("*.mo")} - {"package"}
    assert models == set(MODELS)


def parts(file: Path, classes: dict[str, Path]) -> set[str]:
    """The classes of the library that a class names outside its strings."""
    code = re.sub(r'"(?:[^"\\]|\\.)*"', "", file.read_text(encoding="utf-8"))
    inside = file.parent.name
    found = {f"{inside}.{name}" for name in re.findall(r"(?<![.\w])([A-Z]\w*)", code)}
    found |= set(re.findall(r"(?<![.\w])([A-Z]\w*\.[A-Z]\w*)", code))
    return found & set(classes)


@pytest.mark.parametrize("package", ["Drives", "Mechanics", "Sensors", "Workpieces"])
def test_every_component_is_part_of_a_validation(package):
    classes = {
        f"{path.parent.name}.{path.stem}": path
        for path in LIBRARY.glob("*/*.mo")
        if path.stem != "package"
    }
    reached, waiting = set(), [f"Validation.{model}" for model in MODELS]
    while waiting:
        name = waiting.pop()
        if name not in reached:
            reached.add(name)
            waiting += parts(classes[name], classes)
    assert not {name for name in classes if name.startswith(f"{package}.")} - reached


def test_what_is_spared_says_why():
    for row in read("not_physical.csv"):
        assert row["model"] in MODELS, row
        assert row["reason"], row
