"""A node with digital inputs (CiA 401) on a CAN bus: level only, sampled at the SYNC.

Its objects are `io_objects.csv`. It has NMT, heartbeat, an SDO server and one TPDO with 6000:1; it
sends no emergencies and takes no outputs. Sources: CiA 301 (NMT, SDO, PDO), CiA 401 (6000).
"""

import csv
from collections.abc import Callable, Mapping
from importlib import resources
from typing import Any, Final

import canopen
from canopen.nmt import NmtSlave
from canopen.objectdictionary import ODArray, ODRecord, ODVariable, datatypes
from canopen.sdo.exceptions import SdoAbortedError

from axisrig.bench.bus.can.canopen_sim import SimNetwork
from axisrig.bench.bus.can.simbus import SimBus
from axisrig.bench.drive.canopen.nmt import (
    COMMANDS,
    EVERY_NODE,
    RESET_COMMUNICATION,
    RESET_NODE,
    NmtState,
)
from axisrig.bench.drive.cia402.dictionary.aborts import AbortCode
from axisrig.kernel.profiles.canopen.identifiers import ERROR_CONTROL_BASE, SYNC_ID
from axisrig.kernel.time.clock import MS, Clock, Phase, TimeNs

NOT_VALID: Final = 1 << 31
INPUTS: Final = (0x6000, 1)
SYNC_LAST: Final = 240
_NODE_ID: Final = "$NODEID+"
_TYPES: Final[Mapping[str, int]] = {
    "U8": datatypes.UNSIGNED8,
    "U16": datatypes.UNSIGNED16,
    "U32": datatypes.UNSIGNED32,
    "STRING": datatypes.VISIBLE_STRING,
}
_ARRAYS: Final = (0x6000,)


def io_dictionary(node_id: int) -> canopen.ObjectDictionary:
    """Return the objects of a node as canopen has them."""
    found = canopen.ObjectDictionary()  # type: ignore[no-untyped-call]
    found.node_id = node_id
    text = resources.files(__package__).joinpath("io_objects.csv").read_text(encoding="utf-8")
    for row in csv.DictReader(text.splitlines()):
        index = int(row["index"], 16)
        variable = ODVariable(row["name"], index, int(row["sub"] or 0))
        variable.data_type = _TYPES[row["type"]]
        variable.access_type = row["access"]
        variable.pdo_mappable = bool(row["pdo"])
        variable.default = _default(row["default"], row["type"], node_id)
        if not row["sub"]:
            found.add_object(variable)
            continue
        if index not in found:
            kind = ODArray if index in _ARRAYS else ODRecord
            found.add_object(kind(f"Object {index:04X}", index))
        whole = found[index]
        assert isinstance(whole, ODArray | ODRecord)
        whole.add_member(variable)
    return found


def _default(text: str, kind: str, node_id: int) -> Any:
    if kind == "STRING":
        return text
    offset = node_id if text.startswith(_NODE_ID) else 0
    return int(text.removeprefix(_NODE_ID), 0) + offset


class _Nmt(NmtSlave):
    """State of the node and its heartbeat, in the time of the clock."""

    def __init__(self, node: "IoNode", local: canopen.LocalNode, clock: Clock) -> None:
        super().__init__(node.node_id, local)
        self._node, self._clock = node, clock
        self._run = 0  # counts the starts: an event of an older one does nothing

    def on_command(self, can_id: int, data: bytearray, timestamp: float) -> None:
        """Obey the master; a reset boots."""
        if len(data) != 2 or data[1] not in (EVERY_NODE, self.id):
            return
        if data[0] in (RESET_NODE, RESET_COMMUNICATION):
            self._node.boot()
        elif data[0] in COMMANDS:
            self._node.enter(COMMANDS[data[0]])

    def start_heartbeat(self, heartbeat_time_ms: int) -> None:
        """Send the state every so many ms; 0 = not."""
        self._run += 1
        if heartbeat_time_ms:
            self._beat(self._run, heartbeat_time_ms * MS)

    def stop_heartbeat(self) -> None:
        """Send no more."""
        self._run += 1

    def _beat(self, run: int, period_ns: TimeNs) -> None:
        if run == self._run:
            self._node.send_state()
            due_ns = self._clock.now_ns + period_ns
            self._clock.call_at(due_ns, Phase.APPLICATION, lambda: self._beat(run, period_ns))


class IoNode:
    """One node; levels: called at a SYNC with its instant, gives bit n - 1 for input n.

    network: a connected network of its own (one port of the segment). The node boots with the first
    event that the clock runs.
    """

    def __init__(
        self, node_id: int, network: SimNetwork, clock: Clock, levels: Callable[[TimeNs], int]
    ) -> None:
        self.node_id, self.state = node_id, NmtState.INITIALISING
        self._network, self._clock, self._levels = network, clock, levels
        self._syncs, self._is_on = 0, True
        local = self._local = canopen.LocalNode(node_id, io_dictionary(node_id))
        local._write_callbacks.clear()
        local.nmt = self._nmt = _Nmt(self, local, clock)
        local.add_write_callback(self._check_write)  # type: ignore[no-untyped-call]
        network.add_node(local)
        network.unsubscribe(local.sdo.rx_cobid, local.sdo.on_request)
        network.subscribe(local.sdo.rx_cobid, self._on_sdo)
        network.subscribe(SYNC_ID, self._on_sync)
        clock.call_at(clock.now_ns, Phase.APPLICATION, self.boot)

    @property
    def inputs(self) -> int:
        """6000:1 as it was sampled last."""
        return int.from_bytes(self._local.get_data(*INPUTS), "little")

    def boot(self) -> None:
        """Do what power on does."""
        if not self._is_on:
            return
        self._nmt.stop_heartbeat()
        self._local.data_store.clear()
        self.state, self._syncs = NmtState.INITIALISING, 0
        self.send_state()
        self.state = NmtState.PRE_OPERATIONAL

    def enter(self, state: NmtState) -> None:
        """Take an NMT state; the PDO counts its SYNCs anew."""
        if self.state is not NmtState.INITIALISING:
            self.state, self._syncs = state, 0

    def power_off(self) -> None:
        """Leave the bus for good."""
        self._is_on, self.state = False, NmtState.INITIALISING
        self._nmt.stop_heartbeat()
        if isinstance(self._network.bus, SimBus):
            self._network.bus.power_off()

    def send_state(self) -> None:
        """Send the message of the error control protocol: boot-up or heartbeat."""
        self._network.send_message(ERROR_CONTROL_BASE + self.node_id, bytes((self.state,)))

    def _on_sdo(self, can_id: int, data: bytearray, timestamp: float) -> None:
        """Answer, but not while the node is stopped (CiA 301, NMT states and objects)."""
        if self.state in (NmtState.PRE_OPERATIONAL, NmtState.OPERATIONAL):
            self._local.sdo.on_request(can_id, data, timestamp)  # type: ignore[no-untyped-call]

    def _check_write(self, *, index: int, subindex: int, data: bytes, **_: Any) -> None:
        """Refuse what the node cannot do; begin or end the heartbeat."""
        value = int.from_bytes(data, "little")
        if (index, subindex) == (0x1800, 2) and not 1 <= value <= SYNC_LAST:
            raise SdoAbortedError(AbortCode.INVALID_VALUE)
        if index == 0x1017:
            self._nmt.start_heartbeat(value)

    # At the SYNC

    def _on_sync(self, _can_id: int, _data: bytearray, _timestamp: float) -> None:
        if self.state is NmtState.OPERATIONAL:
            self._clock.call_at(self._clock.now_ns, Phase.APPLICATION, self._sample)

    def _sample(self) -> None:
        value = self._levels(self._clock.now_ns) & 0xFF
        self._local.set_data(*INPUTS, bytes((value,)))
        cob_id = int.from_bytes(self._local.get_data(0x1800, 1), "little")
        every = self._local.get_data(0x1800, 2)[0]
        self._syncs = (self._syncs + 1) % every
        if self._syncs == 0 and not cob_id & NOT_VALID:
            self._network.send_message(cob_id & 0x7FF, bytes((value,)))
