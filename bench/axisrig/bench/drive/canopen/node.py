"""A DS402 drive on a CAN bus: a CANopen slave and a servo.

What the node does on its bus is `slave.py`, what it does with its object values `servo.py` of CiA
402; here they are put together.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Final

from canopen.objectdictionary import ObjectDictionary

from axisrig.bench.bus.can.canopen_sim import SimNetwork
from axisrig.bench.bus.can.simbus import SimBus
from axisrig.bench.drive.axis.ports import AxisPort, SignalPort
from axisrig.bench.drive.canopen.nmt import NmtState
from axisrig.bench.drive.canopen.slave import CanopenSlave, Needs, SlaveHabits
from axisrig.bench.drive.cia402.dictionary.defaults import drive_table
from axisrig.bench.drive.cia402.dictionary.eds import eds_text
from axisrig.bench.drive.cia402.dictionary.foreign import foreign_table, power_on_values
from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.bench.drive.cia402.dictionary.store import Owner
from axisrig.bench.drive.cia402.node import Cia402Node
from axisrig.bench.drive.cia402.profile_objects import PROFILE_OBJECTS, ProfileObjects
from axisrig.kernel.profiles.cia402.ds402 import State
from axisrig.kernel.time.clock import Clock, Phase

CYCLIC_MODES = (8, 9, 10)  # cyclic synchronous position, velocity, torque
MOVING = (State.OPERATION_ENABLED, State.QUICK_STOP_ACTIVE)
STORE_EDS: Final = 0x1021


@dataclass(frozen=True)
class Document:
    """The EDS of the maker: what canopen read of it, and its bytes."""

    dictionary: ObjectDictionary
    text: bytes


class DriveNode(Cia402Node):
    """One drive: a CANopen slave that moves an axis and up to two probe signals.

    node_id: 1 to 127, or 255 for a node that gets its number by LSS. network: a connected network
    of its own (one port of the segment). probes: the signals wired to probe input 1 and 2, None
    for an open input. switches: limit and home switches, "negative", "positive", "home". entered:
    called with each new state of the power drive system. document: the EDS whose objects it has,
    None for those of its profile. seed: of what is random in the drive. The node boots at the
    present instant, that is with the first event the clock runs.
    """

    def __init__(  # noqa: PLR0913
        self,
        name: str,
        node_id: int,
        network: SimNetwork,
        clock: Clock,
        axis: AxisPort,
        probes: tuple[SignalPort | None, SignalPort | None] = (None, None),
        profile: DriveProfile | None = None,
        seed: int = 0,
        *,
        switches: Mapping[str, SignalPort] | None = None,
        entered: Callable[[State], None] | None = None,
        document: Document | None = None,
    ) -> None:
        profile = profile or DriveProfile()
        super().__init__(
            name, clock, axis, probes, profile, seed, switches=switches, entered=entered
        )
        self._network = network
        servo = self.servo
        table = drive_table(profile)
        if document is not None:
            table = foreign_table(profile, document.dictionary)
            servo.power_on.own = {
                name: value
                for (index, _), name, value in power_on_values(document.dictionary)
                if servo.refuses(index, value) is None
            }
        self.slave = CanopenSlave(
            node_id,
            network,
            clock,
            table,
            SlaveHabits(
                profile.sync_loss_periods,
                profile.sdo_answer_ns,
                fixed_pdos=profile.fixed_pdos,
                boots_quietly=profile.boot_up == "power_on",
                first_heartbeat_ns=profile.first_heartbeat_ns,
            ),
            servo,
            Needs(
                lambda: servo.state in MOVING,
                lambda: (
                    servo.state is State.OPERATION_ENABLED
                    and servo.image.mode_display in CYCLIC_MODES
                ),
            ),
        )
        objects = ProfileObjects(servo, profile, clock, self._changed)
        self.slave.objects.own(objects, PROFILE_OBJECTS)
        text = None if document is None else document.text
        self.slave.objects.own(_Document(profile, text), (STORE_EDS,))
        clock.call_at(clock.now_ns, Phase.APPLICATION, self._switched_on)

    @property
    def node_id(self) -> int:
        """The present node number; 255 while it has none."""
        return self.slave.node_id

    @property
    def nmt_state(self) -> NmtState:
        """NMT state; initialising while the drive has no power."""
        return self.slave.state

    def _send_emergency(self, code: int, register: int, info: int) -> None:
        self.slave.emergencies.send(code, register, info)

    def _changed(self) -> None:
        self.slave.exchange.send_events()

    def _boot(self) -> None:
        self.slave.boot()

    def _stop(self) -> None:
        """Leave the bus; a frame that is on it breaks off."""
        self.slave.stop()
        if isinstance(self._network.bus, SimBus):
            self._network.bus.power_off()


class _Document(Owner):
    """1021: the text of the EDS, made when somebody asks for it, or that of the maker."""

    def __init__(self, profile: DriveProfile, text: bytes | None) -> None:
        self._profile, self._text = profile, text

    def read(self, index: int, sub: int) -> bytes:
        """Return the text."""
        if self._text is not None:
            return self._text
        return eds_text(self._profile).encode("ascii")
