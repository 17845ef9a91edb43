"""Plants of one axis and one probe, stepped without the rest of the bench."""

import importlib.util
import sys
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from tests.small_fmus import small_fmu

from axisrig.fmus import MODELS, ensure_built
from axisrig.kernel.cosim.fmi.fmu import FmuSlave, load_fmu
from axisrig.kernel.cosim.fmi.role_table import roles_of
from axisrig.kernel.cosim.fmi.roles import Roles, Source, map_roles
from axisrig.kernel.cosim.plant.plant import Plant

ROOT = Path(__file__).parents[2]
LIBRARIES = {
    "AxisRig": ROOT / "fmus" / "axisrig" / "fmus" / "AxisRig",
    "SteppingTest": Path(__file__).parent / "SteppingTest",
    "EdgeProof": ROOT / "docs" / "plots" / "EdgeProof",
}
TOUCH_PROBE = "AxisRig.Sensors.TouchProbe"


@pytest.fixture(scope="session")
def edge_error() -> ModuleType:
    """The script that makes the picture of the docs."""
    path = ROOT / "docs" / "plots" / "edge_error.py"
    spec = importlib.util.spec_from_file_location("edge_error", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules["edge_error"] = module
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="session")
def fmu() -> Callable[[str], Path]:
    """Builds a model by its full name, once."""

    @cache
    def build_once(model: str) -> Path:
        if model in MODELS:
            return ensure_built(model)
        return small_fmu(model, LIBRARIES[model.partition(".")[0]], 10e-6)

    return build_once


@pytest.fixture
def plant(fmu: Callable[[str], Path]) -> Iterator[Callable[..., Plant]]:
    """Return `plant(axis model, probe model, ...)`: an initialised plant, its wire is `z`.

    axis_start, probe_start: start values. without: roles to be left out. can_save: whether the
    probe is believed to save its state. internal_s, second_internal_s: internal step that the FMU
    of the axis, and of a second one, is believed to have. Everything else goes to `Plant`.
    """
    opened: list[Plant] = []

    def make(
        axis: str,
        probe: str = TOUCH_PROBE,
        *,
        axis_start: Mapping[str, float] = {},
        probe_start: Mapping[str, float] = {},
        without: tuple[str, ...] = (),
        can_save: bool = True,
        internal_s: float | None = None,
        second_internal_s: float | None = None,
        **settings: Any,
    ) -> Plant:
        made = Plant(**settings)
        opened.append(made)

        def roles(slave: FmuSlave, kind: str, coordinates: tuple[str, ...]) -> Roles:
            known = roles_of(kind, coordinates)
            left_out: dict[str, Source | None] = {role: None for role in without if role in known}
            return map_roles(slave, kind, left_out, coordinates)

        def load(model: str, name: str, start: Mapping[str, float]) -> FmuSlave:
            slave = load_fmu(fmu(model), name)
            for variable, value in start.items():
                slave.set_start(variable, value)
            return slave

        slave = load(axis, "axis", axis_start)
        if internal_s is not None:
            slave.can = replace(slave.can, fixed_step_s=internal_s)
        made.add_axis(slave, roles(slave, "axis", ()))
        if second_internal_s is not None:
            slave = load(axis, "second", axis_start)
            slave.can = replace(slave.can, fixed_step_s=second_internal_s)
            made.add_axis(slave, roles(slave, "axis", ()))
        slave = load(probe, "probe", probe_start)
        if not can_save:
            slave.can = replace(slave.can, can_save_state=False)
        made.add_probe(slave, {"z": "axis"}, roles(slave, "probe", ("z",)))
        made.initialize(0)
        return made

    yield make
    for made in opened:
        made.close()
