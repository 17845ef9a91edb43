"""Which probe and which latch a moment of an axis is read from: of the input it measures with."""

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.machine.faults.acts import Act, Injected, nothing
from axisrig.bench.machine.faults.when import Moments, Watched
from axisrig.bench.rig.reading.faults import read_faults
from axisrig.bench.rig.reading.file import read_rig
from axisrig.kernel.time.clock import MS
from axisrig.kernel.time.scheduler import new_scheduler

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


@pytest.mark.parametrize("moment", ["armed", "edge", "latched"])
def test_an_axis_with_nothing_at_its_input_has_no_moment_and_the_other_has_its_own(
    moment: str,
) -> None:
    """X has neither a probe nor a latch at its input 2; of both axes the moment is that of Z."""
    clock, begun = new_scheduler(), list[str]()
    channel: Any = SimpleNamespace(start_ns=0, observers=[])
    latch = SimpleNamespace(is_enabled=False, stored=False)
    latch.has_stored = lambda is_rising: is_rising and latch.stored
    signal = SimpleNamespace(level=False, watches=[])
    found: Any = replace(watched(1), clock=clock, channel=channel)
    found.drives["Z"].latches, found.drives["Z"].latch_watches = [latch], []
    found.plant.probes["first"].signal = signal
    for name in ("second", "other"):
        found.plant.probes[name].signal = SimpleNamespace(level=True, watches=[])
    for link in found.links.values():
        link.edge = "POS"
    (fault,) = read_faults("power_loss", f"Z at={moment}", RIG)
    for axes in ("X", "XZ"):
        act = Act(lambda axes=axes: begun.append(axes), nothing)  # type: ignore[misc]
        Moments(found).run(fault, act, axes, Injected("power_loss", "Z"))
    for cycle in range(4):
        latch.is_enabled = latch.stored = signal.level = cycle == 2
        for observer in channel.observers:
            observer(channel)
        clock.run_until((cycle + 1) * MS)
        assert begun == (["XZ"] if cycle >= 2 else [])
