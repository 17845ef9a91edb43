"""What a scenario leaves for who judges it: facts and series in memory, and where loads creep."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.machine.machine import Machine
from axisrig.bench.machine.recording.received import Received
from axisrig.bench.record.facts import Facts
from axisrig.bench.record.series import Series
from axisrig.bench.tools.scenarios.machines import MachineRow
from axisrig.kernel.channel import Channel
from axisrig.kernel.cosim.plant.probe import SPEED_GAIN_M_S2
from axisrig.kernel.time.clock import MS, S

CALM_NS = 300 * MS
"""How long after the end of the program an axis may still move."""
LOOK_NS = 50 * MS
"""How long it is looked at then."""


@dataclass(frozen=True)
class Left:
    """What a scenario left.

    crept_mm: how far each load moved in LOOK_NS, CALM_NS after an alarm had ended the program, by
    axis; empty where none has, and without axes that a fault has thrown (`thrown`). states: of the
    channel, in their order. hidden: invariants that cannot be decided. received: by the control;
    None where nobody has listened.
    """

    machine: MachineRow
    facts: Facts
    series: Series
    crept_mm: Mapping[str, float] = field(default_factory=dict)
    states: Sequence[str] = ()
    hidden: frozenset[str] = frozenset()
    received: Received | None = None


class StatesSeen:
    """Keeps the states of the channel; an observer of it."""

    def __init__(self) -> None:
        self.names: list[str] = []

    def __call__(self, channel: Channel) -> None:
        """Note the state of this cycle when it is another one."""
        if not self.names or self.names[-1] != channel.state.name:
            self.names.append(channel.state.name)


def thrown(facts: Facts, series: Series) -> frozenset[str]:
    """Return the axes that gained speed as nothing with a mass does (`SPEED_GAIN_M_S2`).

    An axis that follows its demand exactly takes any set position within a cycle, and glides on
    with the speed of that cycle when its drive lets go of it.
    """
    seen = Observed(facts, series)
    largest_mm_s = SPEED_GAIN_M_S2 * 1e3 * facts.timing.period_ns / S
    return frozenset(
        axis
        for axis in facts.axes
        if seen.has(axis, "velocity_mm_s")
        and np.any(np.abs(np.diff(seen.column(axis, "velocity_mm_s"))) > largest_mm_s)
    )


def crept_mm(machine: Machine) -> dict[str, float]:
    """Return how far each load moves in LOOK_NS, CALM_NS after the end; the run goes on for it."""
    plant, axes = machine.plant, machine.settings.rig.axis
    end_ns = max(plant.now_ns, machine.scheduler.now_ns)
    places: list[dict[str, float]] = []
    for after_ns in (CALM_NS, CALM_NS + LOOK_NS):
        machine.scheduler.run_until(end_ns + after_ns)
        plant.advance_to(end_ns + after_ns)
        places.append({n: plant.axes[t.plant].position_m() * 1e3 for n, t in axes.items()})
    before, after = places
    return {name: abs(after[name] - before[name]) for name in before}
