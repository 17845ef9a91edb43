"""Steps that an FMU takes by itself, how its variables are exchanged, and hints at its roles."""

import ctypes
import re
from types import SimpleNamespace
from typing import Any

import pytest
from tests.cosim.test_roles_of_a_description import POSITION, slave_of

from axisrig.kernel.cosim.fmi.library import (
    EndedError,
    Layout,
    Library,
    Missing,
    PlantError,
    grid_of,
    own_step_s,
    standstill,
)
from axisrig.kernel.cosim.fmi.role_table import KINDS, group_of, roles_of
from axisrig.kernel.cosim.fmi.roles import Source, map_roles
from axisrig.kernel.errors import UserError
from axisrig.kernel.time.clock import MS, US

NONE: Any = object()


def description(internal: str | None, experiment: Any = NONE, *, can_vary: bool = False) -> Any:
    """experiment: its step; without one the description has no default experiment."""
    return SimpleNamespace(
        coSimulation=SimpleNamespace(
            fixedInternalStepSize=internal, canHandleVariableCommunicationStepSize=can_vary
        ),
        defaultExperiment=None if experiment is NONE else SimpleNamespace(stepSize=experiment),
    )


@pytest.mark.parametrize(
    ("internal", "experiment", "step_s"),
    [
        ("0.001", NONE, 0.001), ("0.001", None, 0.001), ("0.001", "0.01", 0.001),
        ("0.01", "0.001", 0.01), (None, "0.01", 0.01), (None, None, None), (None, NONE, None),
    ],
)  # fmt: skip
def test_the_internal_step_goes_before_that_of_the_experiment(
    internal: str | None, experiment: Any, step_s: float | None
) -> None:
    assert own_step_s(description(internal, experiment)) == step_s


@pytest.mark.parametrize(
    ("step", "can_vary", "grid_ns"),
    [
        ("0.001", False, MS), ("0.001", True, None), (None, False, None), (None, True, None),
        ("62.5e-6", False, 62_500), ("1e-10", False, 1), ("1e-9", False, 1),
        ("1.6e-9", False, 2), ("0.3", False, 300 * MS), ("5e-5", False, 50 * US),
    ],
)  # fmt: skip
def test_the_grid_is_the_step_of_an_fmu_that_cannot_vary_it(
    step: str | None, can_vary: bool, grid_ns: int | None
) -> None:
    """Whole nanoseconds, and one at least: time would stand still."""
    assert grid_of(description(step, can_vary=can_vary)) == grid_ns
    assert grid_of(description(None, step, can_vary=can_vary)) == grid_ns


@pytest.mark.parametrize(
    ("last_s", "own_s", "is_wrong"),
    [
        (0.010, None, False), (0.011, None, False), (0.010 - 5e-13, None, False),
        (0.010 - 5e-12, None, True), (0.009, None, True), (0.0, 0.0, True),
        (0.009, 0.001, False), (0.0091, 0.001, False), (0.0089, 0.001, True),
        (0.002, 0.008, False), (0.0, 0.008, True),
    ],
)  # fmt: skip
def test_an_fmu_may_wait_for_the_end_of_its_own_step_and_no_longer(
    last_s: float, own_s: float | None, is_wrong: bool
) -> None:
    """The step of the bench ends at 10 ms; less than 1e-12 s is rounding."""
    reason = standstill(last_s, 0.010, own_s)
    wanted = f"the FMU does not advance (lastSuccessfulTime {last_s:.9g} s)"
    assert reason == (wanted if is_wrong else None)


def test_a_time_that_is_no_number_is_no_progress() -> None:
    for own_s in (None, 1.0):
        assert standstill(float("nan"), 0.010, own_s) == (
            "where the FMU has come (lastSuccessfulTime) is no number"
        )


TYPES = {"Real": ("Real", ctypes.c_double), "Integer": ("Integer", ctypes.c_int)}


def variables(*types: str, shape: tuple[int, ...] | None = None) -> Any:
    return [
        SimpleNamespace(name=f"v{number}", type=type_, valueReference=10 - number, shape=shape)
        for number, type_ in enumerate(types)
    ]


@pytest.mark.parametrize(
    ("types", "found"),
    [
        (("Real", "Integer"), "Integer Real"),
        (("Integer", "Real", "Integer"), "Integer Real"),
        (("String", "String"), "String"),
        (("Real", "String", "Real"), "Real String"),
    ],
)
def test_each_type_of_a_list_that_cannot_be_exchanged_is_named_once(
    types: tuple[str, ...], found: str
) -> None:
    with pytest.raises(UserError) as caught:
        Layout.of(variables(*types), TYPES, "plant.fmu")
    names = ", ".join(f"v{number}" for number in range(len(types)))
    assert caught.value.message.startswith(f"FMU plant.fmu: {names} differ in type or have one")
    assert caught.value.value == found
    assert caught.value.allowed == "Real, Integer"


@pytest.mark.parametrize(
    ("shape", "places"), [(None, 3), ((), 3), ((2,), 6), ((2, 5), 30), ((1,), 3)]
)
def test_a_list_takes_as_many_places_as_its_arrays_have(
    shape: tuple[int, ...] | None, places: int
) -> None:
    layout = Layout.of(variables("Real", "Real", "Real", shape=shape), TYPES, "plant.fmu")
    assert (layout.word, layout.kind, layout.places) == ("Real", ctypes.c_double, places)
    assert layout.references == list(layout.array) == [10, 9, 8]


def test_what_a_library_lacks_says_its_name_when_it_is_called() -> None:
    library = Library(SimpleNamespace(_handle=7, fmi2Reset=lambda: 0))
    assert library.fmi2Reset() == 0
    for name in ("fmi2SetReal", "fmi3DoStep"):
        lacking = getattr(library, name)
        assert isinstance(lacking, Missing)
        with pytest.raises(UserError, match=f"has no function {name}"):
            lacking(1, 2)


@pytest.mark.parametrize("kind", [PlantError, EndedError])
def test_the_error_of_a_plant_says_when_to_the_nanosecond(kind: type[PlantError]) -> None:
    error = kind("axis_x", 12_000_001, "gone")
    assert str(error) == "plant axis_x at t = 12.000001 ms: gone"
    assert (error.instance, error.time_ns, error.reason) == ("axis_x", 12_000_001, "gone")


@pytest.mark.parametrize("kind", KINDS)
def test_without_coordinates_no_role_belongs_to_one(kind: str) -> None:
    alone, of_z = roles_of(kind, []), roles_of(kind, ["z"])
    assert not [name for name in alone if "<" in name]
    assert set(alone) == {name for name in of_z if not re.match("(contact_)?z(_|$)", name)}
    assert (alone == of_z) is (kind == "axis")
    assert group_of(kind, (), "plain") == (("demand",) if kind == "axis" else ())


@pytest.mark.parametrize(
    ("unit", "hint"),
    [
        ("rad", "a rotation needs lead_mm, the travel per revolution"), ("s", None),
        ("N.m", None), ("m/s", None), ("um", ""), ("rad2", None),
    ],
)  # fmt: skip
def test_only_a_rotation_is_missing_its_lead(unit: str, hint: str | None) -> None:
    slave = slave_of({**POSITION, "way": ("output", "Float64", unit)})
    sources = {"motor_position": Source("way")}
    if hint == "":
        assert map_roles(slave, "axis", sources).has("motor_position")
        return
    with pytest.raises(UserError, match=f"way is in {unit}") as caught:
        map_roles(slave, "axis", sources)
    assert caught.value.hint == hint
