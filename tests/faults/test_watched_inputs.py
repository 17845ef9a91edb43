"""Which probe and which latch a moment of an axis is read from: of the input it measures with."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.machine.faults.when import Watched
from axisrig.bench.rig.reading.file import read_rig

RIG, _ = read_rig(Path(__file__).parents[2] / "testplans" / "rigs" / "probes-older.toml")


def watched(number: int, latches: int = 2) -> Watched:
    """Z measures with this input; X stands beside it with its own."""
    plant = SimpleNamespace(
        probes={name: SimpleNamespace(signal=name) for name in ("first", "second", "other")}
    )
    tables = {
        "Z": RIG.axis["Z"].model_copy(update={"probe_1": "first", "probe_2": "second"}),
        "X": RIG.axis["Z"].model_copy(update={"probe_1": "other", "probe_2": None}),
    }
    links = {"Z": SimpleNamespace(probe_input=number), "X": SimpleNamespace(probe_input=3 - number)}
    drives = {"Z": SimpleNamespace(latches=[f"latch {n}" for n in range(1, latches + 1)])}
    rest: Any = (SimpleNamespace(), SimpleNamespace(), links, drives, plant)
    return Watched(RIG.model_copy(update={"axis": tables}), *rest)


@pytest.mark.parametrize(("number", "probe"), [(1, "first"), (2, "second")])
def test_the_probe_is_that_of_the_input(number: int, probe: str) -> None:
    found: Any = watched(number)
    assert found.wired("Z") == probe
    assert found.wired("X") == (None if number == 1 else "other")
    assert found.latch("Z") == f"latch {number}"
    assert found.latch("X") is None  # no virtual drive


def test_a_drive_with_one_latch_has_none_of_input_2() -> None:
    assert watched(2, latches=1).latch("Z") is None
    assert watched(1, latches=1).latch("Z") == "latch 1"  # type: ignore[comparison-overlap]
