"""Every component of the library against a reference that does not come from the exporter."""

import ast
import csv
import re
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

from fmus.build import LIBRARY, build, read_models

VALIDATION = LIBRARY.parent / "validation"
STEP_S = 20e-6  # internal step of the validation models of parts
# The validation of a model that is an FMU itself has its internal step.
STEPS_S = {name.rpartition(".")[2]: row.step_s for name, row in read_models().items()}
# A reference made anew on another machine may differ by this share of the tolerance.
REPRODUCED = 1e-3
# What a reference may be made from.
ALLOWED = {*sys.stdlib_module_names, "numpy", "scipy"}
ALLOWED |= {path.stem for path in VALIDATION.glob("*.py")}


def read(name: str) -> list[dict[str, str]]:
    with (VALIDATION / name).open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


SIGNALS = read("signals.csv")
MODELS = tuple(dict.fromkeys(row["model"] for row in SIGNALS))


def stored(model: str, folder: Path = VALIDATION / "references") -> dict[str, np.ndarray]:
    """The columns of a reference by name."""
    with (folder / f"{model}.csv").open(encoding="utf-8", newline="") as file:
        names, *rows = csv.reader(file)
    return dict(zip(names, np.array(rows, dtype=float).T, strict=True))


def rows_of(model: str) -> list[dict[str, str]]:
    return [row for row in SIGNALS if row["model"] == model]


def deviations(fmu, model: str) -> Iterator[tuple[float, str, float]]:
    """Instant, signal and deviation over tolerance, one instant after the other."""
    reference = stored(model)
    rows = [(row["signal"], float(row["tolerance"])) for row in rows_of(model)]
    for k, instant in enumerate(reference["time_s"]):
        if k:
            fmu.step_to(instant)
        for signal, tolerance in rows:
            difference = abs(fmu.get(signal) - reference[signal][k])
            # Not a number is never within the tolerance.
            yield instant, signal, difference / tolerance if difference <= np.inf else np.inf


@pytest.fixture(scope="session")
def validation(cache, load) -> Callable[[str], object]:
    """One instance of each validation model, kept for the session."""
    loaded: dict[str, object] = {}

    def get(model: str):
        if model not in loaded:
            path = build(
                f"AxisRig.Validation.{model}",
                cache / f"{model}.fmu",
                step_s=STEPS_S.get(model, STEP_S),
            )
            loaded[model] = load(path)
        else:
            loaded[model].restart()
        return loaded[model]

    return get


@pytest.mark.parametrize("model", MODELS)
def test_model_is_within_its_tolerances(model, validation):
    outside = [
        f"{signal} at {instant:.6g} s: {ratio:.3g} times the tolerance"
        for instant, signal, ratio in deviations(validation(model), model)
        if ratio > 1
    ]
    assert not outside, "\n".join(outside[:20])


def physical(fmu, model: str) -> dict[str, list[float]]:
    """The parameters of a validation model that it must notice, with their values."""
    spared = {row["parameter"] for row in read("not_physical.csv") if row["model"] == model}
    parameters = {
        v.name: [float(element) for element in v.start.split()]
        for v in fmu.description.modelVariables
        if v.causality == "parameter" and v.type == "Float64"
    }
    assert spared <= set(parameters), "not_physical.csv names what is not there"
    return {name: value for name, value in parameters.items() if name not in spared}


@pytest.mark.parametrize("model", MODELS)
def test_one_percent_of_any_physical_parameter_is_noticed(model, validation):
    fmu = validation(model)
    unnoticed = []
    for name, elements in physical(fmu, model).items():
        for k, value in enumerate(elements):
            if value:
                fmu.restart(**{name: [*elements[:k], 1.01 * value, *elements[k + 1 :]]})
                if all(ratio <= 1 for _, _, ratio in deviations(fmu, model)):
                    unnoticed.append(f"{name}, element {k} = {value!r}")
    assert not unnoticed, unnoticed


def test_a_parameter_that_is_zero_in_one_model_is_a_number_in_another(validation):
    """Zero has no percent, so that another model with the same component must notice it."""
    values: dict[str, set[float]] = {}
    for model in MODELS:
        for name, value in physical(validation(model), model).items():
            values.setdefault(name.rpartition(".")[2], set()).update(value)
    assert not {name for name, found in values.items() if found == {0.0}}


def test_stored_references_are_those_that_the_scripts_make(tmp_path):
    script = VALIDATION / "make_references.py"
    subprocess.run([sys.executable, str(script), "--into", str(tmp_path)], check=True, timeout=300)
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
