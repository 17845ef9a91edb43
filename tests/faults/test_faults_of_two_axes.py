"""Faults beside the drives and of images: whose they are, and what of them is counted."""

import random
from collections.abc import Sequence
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.machine.faults.acts import Injected
from axisrig.bench.machine.faults.beside import Beside
from axisrig.bench.machine.faults.images import KINDS
from axisrig.bench.rig.reading.file import read_rig
from axisrig.bench.rig.settings import read_settings
from axisrig.kernel.time.clock import MS

RIG = Path(__file__).parents[2] / "testplans" / "rigs" / "probe-xyz.toml"


@pytest.mark.interpreted
def test_the_inputs_of_one_drive_are_crossed_and_of_no_other() -> None:
    """Signals are named here by their probes; an open input is crossed like any other."""
    rig, files = read_rig(RIG)
    axes = {axis: table.model_copy(update={"probe_2": None}) for axis, table in rig.axis.items()}
    settings = read_settings(rig.model_copy(update={"axis": axes}), files, [])
    tables = settings.rig.axis
    names = {name for table in tables.values() for name in table.signals.values()}
    plant: Any = SimpleNamespace(probes={name: SimpleNamespace(signal=name) for name in names})
    clock: Any = SimpleNamespace(now_ns=0)
    beside = Beside(settings, plant, clock)
    as_wired = {axis: (table.probe_1, table.probe_2) for axis, table in tables.items()}
    assert {axis: beside.probes(axis) for axis in tables} == as_wired
    assert as_wired == dict.fromkeys("XYZ", ("probe", None))
    for crossed in ("Y", "Z"):
        beside.cross(crossed)
        first, second = as_wired[crossed]
        as_wired[crossed] = (second, first)
        assert {axis: beside.probes(axis) for axis in tables} == as_wired


@pytest.mark.interpreted
@pytest.mark.parametrize(
    ("keys", "hit"),
    [
        ({"p": 1.0, "skip": 0, "count": None}, [3, 4, 5, 6]),
        ({"p": 1.0, "skip": 2, "count": None}, [5, 6]),
        ({"p": 1.0, "skip": 1, "count": 2}, [4, 5]),
        ({"p": 0.0, "skip": 0, "count": None}, []),
    ],
)
@pytest.mark.parametrize("place", ["lost", "missed", "late"])
def test_images_that_are_hit_are_counted_and_no_others(
    place: str, keys: dict[str, Any], hit: Sequence[int]
) -> None:
    """Ten images, one each ms; the fault acts from 2.5 to 6.5 ms, and of Z alone."""
    clock: Any = SimpleNamespace(now_ns=0)
    asked: dict[str, dict[str, list[Any]]] = {
        name: {"X": [], "Z": []} for name in ("lost", "missed", "late")
    }
    on: Any = SimpleNamespace(clock=clock, segment=SimpleNamespace(**asked))
    fault: Any = SimpleNamespace(axis="Z", values=keys)
    record = Injected(f"image_{place}", "Z")
    act = KINDS[f"image_{place}"](on, fault, random.Random(1), record)
    (falls,) = asked[place]["Z"]
    assert sum(len(found) for of_axis in asked.values() for found in of_axis.values()) == 1
    fallen = []
    for number in range(1, 11):
        if number == 3:
            act.begin()
        if number == 7:
            act.end()
        clock.now_ns = number * MS
        if falls():
            fallen.append(number)
    assert fallen == hit
    assert record.hits == len(hit)
