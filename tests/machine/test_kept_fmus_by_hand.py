"""Which instance of an FMU a machine gets, step by step, and what is remembered of one."""

from collections import OrderedDict
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.machine import kept_fmus
from axisrig.bench.machine.kept_fmus import ROLES_MAX, close_fmus, close_plant, roles_of, take_fmu
from axisrig.bench.rig.reading.file import PlantTable

pytestmark = pytest.mark.interpreted  # stand-ins for typed parts

OWN = Path("own.fmu")


class Slave:
    """An instance that runs; its number is its handle."""

    def __init__(self, path: Path, name: str, number: int, closed: list[int]) -> None:
        self.path, self.name, self.number, self.pointer = path, name, number, number
        self.is_own, self._closed = False, closed

    def close(self) -> None:
        if self.pointer:
            self._closed.append(self.number)
        self.pointer = 0


class World:
    """Instances by the order in which they were loaded; closed: numbers of those that are freed."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.loaded = 0
        self.closed: list[int] = []
        self.state, self.is_watched, self.resets, self.sets_aside = "first", False, True, True
        monkeypatch.setattr(kept_fmus, "_kept", OrderedDict())
        monkeypatch.setattr(kept_fmus, "load_fmu", self._load)
        monkeypatch.setattr(kept_fmus, "reset", self._reset)
        monkeypatch.setattr(kept_fmus, "set_aside", self._set_aside)
        monkeypatch.setattr(kept_fmus, "_state", lambda path: (path, self.state))
        monkeypatch.setattr(kept_fmus.journal, "is_open", lambda: self.is_watched)

    def _load(self, path: Path, name: str) -> Any:
        self.loaded += 1
        return Slave(path, name, self.loaded, self.closed)

    def _reset(self, slave: Any, handle: int) -> bool:
        slave.pointer = handle
        return self.resets

    def _set_aside(self, slave: Any) -> int:
        if not self.sets_aside:
            return 0
        handle, slave.pointer = slave.pointer, 0
        return int(handle)

    def used(self, name: str = "z", path: Path = OWN) -> int:
        """Take an instance and give it back; return its number."""
        slave: Any = take_fmu(path, name)
        assert slave.pointer
        assert slave.is_own
        close_fmus([slave, slave])
        return int(slave.number)


@pytest.fixture
def world(monkeypatch: pytest.MonkeyPatch) -> World:
    return World(monkeypatch)


def test_an_instance_is_used_again_under_its_name_and_of_its_file(world: World) -> None:
    assert [world.used(), world.used(), world.used("x"), world.used()] == [1, 1, 2, 1]
    assert [world.used("z", Path("other.fmu")), world.used()] == [3, 1]
    assert world.closed == []


@pytest.mark.parametrize("change", ["state", "is_watched", "resets"])
def test_what_is_no_longer_the_same_is_loaded_anew_once(world: World, change: str) -> None:
    """Another file, calls that are noted or are no longer, a reset that does not work."""
    assert world.used() == 1
    before = getattr(world, change)
    setattr(world, change, "second" if change == "state" else not before)
    assert world.used() == 2
    assert world.closed == [1]
    world.resets = True
    assert world.used() == 2  # that is the kept one from now on
    if change != "resets":
        setattr(world, change, before)
        assert world.used() == 3
        assert world.closed == [1, 2]


def test_who_takes_one_that_is_in_use_gets_another_that_is_not_kept(world: World) -> None:
    first: Any = take_fmu(OWN, "z")
    second: Any = take_fmu(OWN, "z")
    third: Any = take_fmu(OWN, "z")
    assert [each.number for each in (first, second, third)] == [1, 2, 3]
    close_fmus([second])
    assert world.closed == [2]
    close_fmus([first, third])
    assert world.closed == [2, 3]
    assert world.used() == 1


def test_one_that_somebody_has_freed_is_forgotten(world: World) -> None:
    first: Any = take_fmu(OWN, "z")
    first.close()
    close_fmus([first])
    assert [world.used(), world.used()] == [2, 2]
    world.sets_aside = False
    assert world.used() == 2
    assert world.closed == [1, 2]
    assert not kept_fmus._kept
    world.sets_aside = True
    assert [world.used(), world.used()] == [3, 3]


def test_those_that_were_not_used_for_longest_are_let_go(
    world: World, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(kept_fmus, "KEPT_MAX", 3)
    assert [world.used(name) for name in "xyzxv"] == [1, 2, 3, 1, 4]
    assert world.closed == [2]
    kept_fmus.forget()
    assert world.closed == [2, 3, 1, 4]
    assert [world.used(name) for name in "xy"] == [5, 6]


def test_those_in_use_are_not_freed_when_all_others_are(world: World) -> None:
    """They stay known: given back, they are used again."""
    used: Any = take_fmu(OWN, "used")
    assert [world.used("a"), world.used("b")] == [2, 3]
    kept_fmus.forget()
    assert (world.closed, used.pointer) == ([2, 3], 1)
    close_fmus([used])
    assert [world.used("used"), world.used("a")] == [1, 4]
    kept_fmus.forget()
    assert world.closed == [2, 3, 1, 4]


def test_a_machine_gives_back_axes_probes_and_sensors_each_once(world: World) -> None:
    slaves: list[Any] = [take_fmu(OWN, name) for name in "xyz"]
    forgotten: list[str] = []

    def axis(name: str, slave: Any) -> Any:
        return SimpleNamespace(slave=slave, forget=lambda: forgotten.append(name))

    plant: Any = SimpleNamespace(
        axes={"a": axis("a", slaves[0]), "b": axis("b", slaves[0])},
        probes={"p": SimpleNamespace(slave=slaves[1])},
        distances={"d": SimpleNamespace(slave=slaves[2])},
    )
    close_plant(plant)
    assert forgotten == ["a", "b"]
    assert [slave.pointer for slave in slaves] == [0, 0, 0]
    assert world.closed == []
    assert [world.used(name) for name in "xyz"] == [1, 2, 3]


def test_roles_are_found_once_for_each_table_of_a_kept_instance(world: World) -> None:
    found: list[str] = []

    def find() -> Any:
        found.append(f"roles {len(found)}")
        return found[-1]

    tables = [PlantTable(fmu="own.fmu", suffix=f"_{number}") for number in range(ROLES_MAX + 1)]
    slave: Any = take_fmu(OWN, "z")
    for _ in range(2):
        for number, table in enumerate(tables[:-1]):
            equal = table.model_copy()
            assert {roles_of(slave, each, find) for each in (table, equal)} == {f"roles {number}"}
    assert len(found) == ROLES_MAX
    # One more: the oldest one is found out anew, the second oldest is not
    assert roles_of(slave, tables[-1], find) == f"roles {ROLES_MAX}"
    assert roles_of(slave, tables[1], find) == "roles 1"
    assert roles_of(slave, tables[0], find) == f"roles {ROLES_MAX + 1}"
    other: Any = take_fmu(OWN, "z")  # not kept: nothing is remembered of it
    before = len(found)
    assert len({roles_of(other, tables[2], find) for _ in range(2)}) == 2
    assert len(found) == before + 2
