"""Inputs of FMUs that are held for a time, over a plant made by hand: what they go back to."""

from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.kernel.cosim.plant import inputs
from axisrig.kernel.cosim.plant.inputs import HeldInput, parts_of
from axisrig.kernel.cosim.plant.probe import SUPPLY
from axisrig.kernel.time.clock import MS


class Values:
    """One input of an FMU, whose values rest in a dictionary."""

    def __init__(self, slave: dict[str, Any], names: list[str]) -> None:
        self._slave, (self._name,) = slave, names
        self.values: list[Any] = [0.0]

    def read(self) -> None:
        self.values[0] = self._slave[self._name]

    def write(self) -> None:
        self._slave[self._name] = self.values[0]


class Plant:
    """An axis, a probe and a distance sensor; calls: of plant and probe, each with its ns."""

    def __init__(self) -> None:
        self.calls: list[tuple[str, int]] = []
        self.fmus: dict[str, dict[str, Any]] = {
            "z": {"load": 2.5, "is_hot": False, "steps": 7},
            "probe": {SUPPLY: True, "noise": 0.25},
            "gap": {"noise": 0.5, SUPPLY: 3.0},
        }
        roles = {name: SimpleNamespace(slave=fmu) for name, fmu in self.fmus.items()}
        self.axes = {"z": SimpleNamespace(roles=roles["z"])}
        self.distances = {"gap": SimpleNamespace(roles=roles["gap"])}
        self.probe = SimpleNamespace(
            roles=roles["probe"], is_supply_held=False, is_switched_on=True,
            wake=lambda now_ns: self.calls.append(("wake", now_ns)),
        )  # fmt: skip
        self.probes = {"probe": self.probe}

    def advance_to(self, now_ns: int) -> None:
        self.calls.append(("advance", now_ns))


@pytest.fixture
def plant(monkeypatch: pytest.MonkeyPatch) -> Any:
    monkeypatch.setattr(inputs, "Exchange", Values)
    return Plant()


def test_the_parts_of_a_plant_are_its_axes_probes_and_sensors(plant: Any) -> None:
    found = parts_of(plant)
    assert {name: roles.slave for name, roles in found.items()} == plant.fmus


@pytest.mark.parametrize(
    ("instance", "name", "given", "held"),
    [
        ("z", "load", 9.0, 9.0), ("z", "is_hot", 1.0, True), ("z", "is_hot", 0.0, False),
        ("z", "steps", 3.0, 3), ("probe", "noise", 4.0, 4.0), ("gap", "noise", 0.0, 0.0),
        ("gap", SUPPLY, 1.0, 1.0),
    ],
)  # fmt: skip
def test_an_input_goes_back_to_what_it_had_each_time(
    plant: Any, instance: str, name: str, given: float, held: Any
) -> None:
    """In the type of the variable; a value that it got between two times is its own then."""
    fmu = plant.fmus[instance]
    before, others = fmu[name], {key: value for key, value in fmu.items() if key != name}
    one = HeldInput(plant, instance, name)
    for _ in range(2):
        one.begin(given, MS)
        assert (fmu[name], type(fmu[name])) == (held, type(before))
        one.end(2 * MS)
        assert fmu[name] == before
        fmu[name] = before = type(before)(not before)
    assert {key: value for key, value in fmu.items() if key != name} == others
    assert not plant.probe.is_supply_held


@pytest.mark.parametrize(("instance", "name"), [("z", "load"), ("gap", "noise")])
def test_the_plant_is_at_the_instant_at_which_an_input_changes(
    plant: Any, instance: str, name: str
) -> None:
    held = HeldInput(plant, instance, name)
    assert plant.calls == []
    held.begin(1.0, 3 * MS)
    assert plant.calls == [("advance", 3 * MS)]
    held.end(5 * MS)
    assert plant.calls == [("advance", 3 * MS), ("advance", 5 * MS)]


@pytest.mark.parametrize("name", ["noise", SUPPLY])
def test_a_probe_is_followed_from_each_change_of_an_input_on(plant: Any, name: str) -> None:
    held = HeldInput(plant, "probe", name)
    held.begin(0.0, 3 * MS)
    held.end(5 * MS)
    assert plant.calls == [
        ("advance", 3 * MS), ("wake", 3 * MS), ("advance", 5 * MS), ("wake", 5 * MS),
    ]  # fmt: skip


@pytest.mark.parametrize("value", [0.0, 1.0])
@pytest.mark.parametrize("was_on", [True, False])
@pytest.mark.parametrize("ordered", [True, False])
def test_a_supply_comes_back_as_the_plc_has_ordered_it_last(
    plant: Any, value: float, was_on: bool, ordered: bool
) -> None:
    fmu = plant.fmus["probe"]
    fmu[SUPPLY] = plant.probe.is_switched_on = was_on
    held = HeldInput(plant, "probe", SUPPLY)
    held.begin(value, MS)
    assert (fmu[SUPPLY], plant.probe.is_supply_held) == (bool(value), True)
    plant.probe.is_switched_on = ordered
    held.end(2 * MS)
    assert (fmu[SUPPLY], plant.probe.is_supply_held) == (ordered, False)
    assert plant.probe.is_switched_on is ordered
