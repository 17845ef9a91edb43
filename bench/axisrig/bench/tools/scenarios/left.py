"""What a scenario leaves for who judges it: facts and series in memory, and where loads creep."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from axisrig.bench.machine.machine import Machine
from axisrig.bench.record.facts import Facts
from axisrig.bench.record.series import Series
from axisrig.bench.tools.scenarios.machines import MachineRow
from axisrig.kernel.channel import Channel
from axisrig.kernel.time.clock import MS

CALM_NS = 300 * MS
"""How long after the end of the program an axis may still move."""
LOOK_NS = 50 * MS
"""How long it is looked at then."""


@dataclass(frozen=True)
class Left:
    """What a scenario left.

    crept_mm: how far each load moved in
    LOOK_NS, CALM_NS after an alarm had ended the program, by axis; empty where none has. states: of
    the channel, in their order. hidden: invariants that cannot be decided.
    """

    machine: MachineRow
    facts: Facts
    series: Series
    crept_mm: Mapping[str, float] = field(default_factory=dict)
    states: Sequence[str] = ()
    hidden: frozenset[str] = frozenset()


class StatesSeen:
    """Keeps the states of the channel; an observer of it."""

    def __init__(self) -> None:
        self.names: list[str] = []

    def __call__(self, channel: Channel) -> None:
        """Note the state of this cycle when it is another one."""
        if not self.names or self.names[-1] != channel.state.name:
            self.names.append(channel.state.name)


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
