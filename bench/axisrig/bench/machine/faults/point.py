"""Places of a machine where faults can act, by the names that a plan has for them."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Protocol

from axisrig.bench.rig.faults import open_targets
from axisrig.bench.rig.reading.fault_targets import axes_of
from axisrig.bench.rig.reading.faults import fault_kinds
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.cosim.plant.plant import Plant


class Equipped(Protocol):
    """A machine, as far as its fault points ask; `Machine` is one."""

    settings: Settings
    plant: Plant


@dataclass(frozen=True)
class FaultPoint:
    """A place where faults can act.

    target: its name, as in a cell `fault:KIND` (`Z.TPDO1`, `can1`, `probe`). kinds: of
    `faults.csv`, that can be done to it. axes: whose moments `at` counts.
    """

    target: str
    kinds: tuple[str, ...]
    axes: tuple[str, ...]


Points = dict[str, FaultPoint]


def points_of(machine: Equipped, kinds: Iterable[str]) -> Points:
    """Return the points of a machine where these kinds can act, in the order of kinds and rig."""
    rig = machine.settings.rig
    found: dict[str, list[str]] = {}
    axes: dict[str, tuple[str, ...]] = {}
    for name in kinds:
        kind = fault_kinds()[name]
        for target in open_targets(kind, machine.settings):
            found.setdefault(target, []).append(name)
            axes.setdefault(target, axes_of(target, kind.targets, rig))
    return {
        target: FaultPoint(target, tuple(names), axes[target]) for target, names in found.items()
    }
