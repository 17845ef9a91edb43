"""A node with digital inputs (CiA 401) on a CAN bus: level only, sampled at the SYNC.

A CANopen slave whose objects are `io_objects.csv`, with one TPDO of 6000:1; it has no emergencies
(1014) and takes no outputs. Source: CiA 401 (6000).
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from importlib import resources
from typing import Final

from axisrig.bench.bus.can.canopen_sim import SimNetwork
from axisrig.bench.bus.can.simbus import SimBus
from axisrig.bench.drive.canopen.slave import CanopenSlave, Needs, SlaveHabits
from axisrig.bench.drive.cia402.dictionary.defaults import default_value
from axisrig.bench.drive.cia402.dictionary.image import DeviceImage
from axisrig.bench.drive.cia402.dictionary.objects import Key, ObjectTable, read_rows
from axisrig.bench.drive.cia402.error_register import ErrorRegister
from axisrig.kernel.time.clock import Clock, Phase, TimeNs

INPUT_MASK: Final = 0xFF
_HABITS: Final = SlaveHabits(beats_first=True)


@cache
def io_table() -> ObjectTable:
    """Return the objects of the node."""
    rows = {row.key: row for row in read_rows(resources.files(__package__) / "io_objects.csv")}

    def defaults(node_id: int) -> Mapping[Key, int | bytes]:
        return {key: default_value(row, row.default, node_id) for key, row in rows.items()}

    return ObjectTable(
        rows,
        {key: row.data_type.format.islower() for key, row in rows.items()},
        frozenset(row.index for row in rows.values()),
        lambda index, sub: (index, sub) in rows,
        defaults,
    )


@dataclass(slots=True)
class InputImage(DeviceImage):
    """The process image of the node: 6000:1 as it was sampled last, bit n - 1 for input n."""

    inputs: int = 0


class DigitalInputs:
    """The device of the slave; levels: called at a SYNC with its instant."""

    def __init__(
        self, levels: Callable[[TimeNs], int], send: Callable[[int, int, int], None]
    ) -> None:
        self._levels = levels
        self.image = InputImage()
        self.emergency = ErrorRegister(self.image, send)

    def reset(self, now_ns: TimeNs) -> None:
        """Do what power off and on does."""
        self.image.inputs = 0
        self.emergency.forget()

    def begin(self, now_ns: TimeNs) -> None:
        """Do nothing: there is no plant behind an input."""

    def cycle(self, now_ns: TimeNs) -> None:
        """Sample the inputs."""
        self.image.inputs = self._levels(now_ns) & INPUT_MASK

    def react(self, now_ns: TimeNs) -> None:
        """Do nothing: no value of the node acts on it."""

    def refresh(self, now_ns: TimeNs) -> None:
        """Do nothing: the inputs are sampled at the SYNC."""

    def connection_lost(self, now_ns: TimeNs, code: int) -> None:
        """Do nothing: the node has no outputs."""

    def update(self) -> None:
        """Do nothing: the node has no parameters of its own."""

    def watch(self, names: frozenset[str]) -> None:
        """Do nothing: one value costs no more where nobody reads it."""


class IoNode:
    """One node; levels: called at a SYNC with its instant, gives bit n - 1 for input n.

    network: a connected network of its own (one port of the segment). The node boots with the first
    event that the clock runs.
    """

    def __init__(
        self, node_id: int, network: SimNetwork, clock: Clock, levels: Callable[[TimeNs], int]
    ) -> None:
        self._network, self._is_on = network, True
        inputs = DigitalInputs(levels, self._send_emergency)
        self.slave = CanopenSlave(
            node_id,
            network,
            clock,
            io_table(),
            _HABITS,
            inputs,
            Needs(lambda: False, lambda: False),
        )
        clock.call_at(clock.now_ns, Phase.APPLICATION, self._boot)

    @property
    def node_id(self) -> int:
        """The present node number."""
        return self.slave.node_id

    def _send_emergency(self, code: int, register: int, info: int) -> None:
        self.slave.emergencies.send(code, register, info)

    def _boot(self) -> None:
        if self._is_on:
            self.slave.boot()

    def power_off(self) -> None:
        """Leave the bus for good."""
        self._is_on = False
        self.slave.stop()
        if isinstance(self._network.bus, SimBus):
            self._network.bus.power_off()
