"""The same model as FMI 2.0 and as FMI 3.0: the same bits."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import fmpy
import pytest
from fmpy.fmi2 import FMU2Slave
from fmpy.fmi3 import FMU3Slave

import axisrig.fmus.build as building

FOLDER = Path(__file__).parent
MODELS = [
    "Classics.Lorenz",
    "Circuits.Chua",
    "Control.CascadeWithEvents",
    "Control.PIDSampled",
    "Process.Thermostat",
    "Logic.SameInstant",
]
# FMI 2.0 has no type for it but these.
GET_2 = {"Float64": "getReal", "Real": "getReal", "Integer": "getInteger", "Boolean": "getBoolean"}


@contextmanager
def instance(path: Path, folder: Path) -> Iterator[tuple[Any, Any]]:
    """An initialized slave of either version and its description."""
    description = fmpy.read_model_description(str(path))
    fmpy.extract(str(path), str(folder))
    kind = FMU2Slave if description.fmiVersion == "2.0" else FMU3Slave
    slave = kind(
        guid=description.guid,
        unzipDirectory=str(folder),
        modelIdentifier=description.coSimulation.modelIdentifier,
        instanceName="x",
    )
    slave.instantiate()
    if kind is FMU2Slave:
        slave.setupExperiment(startTime=0.0)
    slave.enterInitializationMode()
    slave.exitInitializationMode()
    yield slave, description
    slave.terminate()
    slave.freeInstance()


def trace(path: Path, folder: Path) -> dict[str, list[float]]:
    """Scalar outputs at uneven steps."""
    with instance(path, folder) as (slave, description):
        outputs = [v for v in description.modelVariables if v.causality == "output"]
        found: dict[str, list[float]] = {v.name: [] for v in outputs}
        now = 0
        for k in range(60):
            size = (k * 7919) % 83_000_000 + 1
            slave.doStep(now * 1e-9, size * 1e-9)
            now += size
            for v in outputs:
                is_2 = description.fmiVersion == "2.0"
                get = getattr(slave, GET_2[v.type] if is_2 else f"get{v.type}")
                found[v.name].append(float(get([v.valueReference])[0]))
        return found


@pytest.mark.long
@pytest.mark.parametrize("model", MODELS)
def test_both_versions_give_the_same_bits(tmp_path, model):
    library = FOLDER / model.partition(".")[0]
    traces = [
        trace(
            building.build(model, tmp_path / f"{version}.fmu", library, fmi=version),
            tmp_path / version,
        )
        for version in ("2.0", "3.0")
    ]
    assert traces[0] == traces[1]
    assert len(traces[0]) > 0
