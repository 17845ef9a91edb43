"""A CiA 401 node on a CAN bus as the terminal of the PLC: the node, and the PLC's end of it.

    edge -> filter -> SYNC: level sampled -> TPDO -> image -> cycle of the PLC

The image has levels only, no time stamps. A telegram counts for the SYNC that it can answer alone
(`NodeTelegrams`), and two of one SYNC that differ count as none: the image stays, and where a cycle
of the PLC has read the first of them the next one sees that its inputs are not to be trusted. The
PLC side starts the node when it boots: it checks 1000, writes 1017 and sends NMT start (CiA 302-2).
It counts as lost while it is not operational, when its telegram is missing for longer than
`missing_cycles` periods, and when its heartbeat is missing for twice its time.
"""

from collections.abc import Callable, Mapping
from typing import Final

from axisrig.bench.bus.can.canopen_sim import SimNetwork
from axisrig.bench.drive.axis.ports import SignalPort
from axisrig.bench.drive.canopen.io_node import IoNode
from axisrig.bench.machine.plc.terminal import ChannelInput, InputChannel
from axisrig.bench.rig.canopen.io_node import NodeTelegrams
from axisrig.bench.rig.reading.plc_task import TerminalTable, silent_ns
from axisrig.kernel.drives.canopen.sdo import SdoClient
from axisrig.kernel.drives.canopen.startup import DriveAddress, StartUp
from axisrig.kernel.drives.canopen.startup_steps import (
    PROFILE_MASK,
    Check,
    Nmt,
    StartUpSettings,
    Write,
)
from axisrig.kernel.errors import Alarm
from axisrig.kernel.profiles.canopen.identifiers import ERROR_CONTROL_BASE, PDO_BASE
from axisrig.kernel.profiles.canopen.nmt import BOOT_UP, OPERATIONAL, START
from axisrig.kernel.time.clock import MS, Clock, Phase, TimeNs

PROFILE: Final = 401


class IoTerminal:
    """The node of a rig and the PLC's image of it, as `Terminal`.

    signals: the probes of the rig. node_port: the network of the node; master: the network of who
    starts it and hears its telegrams. advance: steps the plants to an instant. telegrams: those of
    the node. wc_state: 0 while they come, 1 else; the image then stays as it was.
    """

    def __init__(
        self,
        table: TerminalTable,
        signals: Mapping[str, SignalPort],
        clock: Clock,
        *,
        node_port: SimNetwork,
        master: SimNetwork,
        advance: Callable[[TimeNs], None],
        telegrams: NodeTelegrams,
    ) -> None:
        assert table.node is not None
        self._table, self._clock, self._advance = table, clock, advance
        self._channels = {
            number: InputChannel(signals[name], table, 0) for number, name in table.inputs.items()
        }
        self._sampled = {number: ChannelInput() for number in self._channels}
        self.image = dict(self._sampled)
        self._telegrams = telegrams
        self._limit_ns = (table.missing_cycles + 1) * telegrams.period_ns
        self._came_ns: TimeNs | None = None
        self._sync = -1  # number of the SYNC that was answered last
        self._answer: int | None = None  # to it; None: two that differ
        self._before: tuple[dict[int, ChannelInput], TimeNs | None] = (self.image, None)
        self._read_ns: TimeNs = -1
        self._misled = self._is_doubtful = False
        self._alive_ns: TimeNs | None = None  # None: not operational
        self._start_up = StartUp(
            DriveAddress("terminal", table.node),
            master,
            clock,
            SdoClient(master, clock, table.node),
            (
                Check("0x1000:0 device type", 0x1000, 0, PROFILE, PROFILE_MASK),
                Write("0x1017:0", 0x1017, 0, table.heartbeat_ms.to_bytes(2, "little")),
                Nmt("NMT start", START),
            ),
            StartUpSettings(boot="none", device_type=PROFILE),
        )
        self.node = IoNode(table.node, node_port, clock, self._levels)
        master.subscribe(ERROR_CONTROL_BASE + table.node, self._on_state)
        master.subscribe(PDO_BASE["TPDO1"] + table.node, self._on_telegram)
        off_ns = silent_ns(table.silent_from_ms)
        if off_ns is not None:
            clock.call_at(off_ns, Phase.APPLICATION, self.node.power_off)

    def exchange_until(self, now_ns: TimeNs) -> None:
        """Note that the PLC reads the image now, which the telegrams of the node make."""
        self._read_ns = now_ns
        self._is_doubtful, self._misled = self._misled, False

    @property
    def wc_state(self) -> int:
        """0 while the node answers."""
        now_ns, heartbeat_ns = self._clock.now_ns, self._table.heartbeat_ms * MS
        if self._is_doubtful or self._came_ns is None or now_ns - self._came_ns > self._limit_ns:
            return 1
        if self._alive_ns is None or (heartbeat_ns and now_ns - self._alive_ns > 2 * heartbeat_ns):
            return 1
        return 0

    # In the node

    def _levels(self, now_ns: TimeNs) -> int:
        """Sample the inputs at the SYNC."""
        self._advance(now_ns)
        value = 0
        for number, channel in self._channels.items():
            seen = channel.exchange(now_ns, lambda _: 0, self._sampled[number])
            self._sampled[number] = seen
            value |= seen.input << number - 1
        return value

    # In the PLC

    def _on_state(self, _can_id: int, data: bytearray, _timestamp: float) -> None:
        if len(data) != 1:
            return
        if data[0] == BOOT_UP:
            self._alive_ns = self._came_ns = None
            self._start_up.begin(self._on_started)
        elif data[0] == OPERATIONAL:
            self._alive_ns = self._clock.now_ns
        elif self._alive_ns is not None and self._came_ns is not None:
            self._alive_ns = None  # somebody else has stopped it

    def _on_started(self, alarm: Alarm | None) -> None:
        """Count the node as there; one that could not be started stays lost."""
        if alarm is None:
            self._alive_ns = self._clock.now_ns

    def _on_telegram(self, _can_id: int, data: bytearray, _timestamp: float) -> None:
        now_ns, node = self._clock.now_ns, self._telegrams
        sync, since_ns = divmod(now_ns, node.period_ns)
        if len(data) != 1 or not node.first_ns <= since_ns <= node.last_ns:
            return
        if sync != self._sync:
            self._sync, self._answer = sync, data[0]
            self._before = self.image, self._came_ns
            self._came_ns = now_ns
            self.image = {
                number: ChannelInput(bool(data[0] >> number - 1 & 1)) for number in self._channels
            }
        elif self._answer is not None and data[0] != self._answer:
            self._answer = None
            self._misled = self._came_ns is not None and self._read_ns >= self._came_ns
            self.image, self._came_ns = self._before
