"""Who is alive: heartbeats that the node sends and watches, and node guarding.

Source: CiA 301, error control services; objects 100C, 100D, 1016, 1017. A heartbeat producer time
switches node guarding off.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import ClassVar, Final

from axisrig.bench.bus.can.canopen_sim import SimNetwork
from axisrig.bench.drive.axis.timer import Timer
from axisrig.bench.drive.cia402.dictionary.aborts import AbortCode, abort
from axisrig.bench.drive.cia402.dictionary.store import ObjectStore, Owner
from axisrig.kernel.profiles.canopen.identifiers import ERROR_CONTROL_BASE
from axisrig.kernel.time.clock import MS, Clock, Phase, TimeNs

GUARD_TIME, LIFE_TIME_FACTOR = 0x100C, 0x100D
CONSUMER_TIME, PRODUCER_TIME = 0x1016, 0x1017
BOOT_UP = b"\x00"
NODE_ID_MAX: Final = 127
TOGGLE: Final = 0x80


class HeartbeatProducer(Owner):
    """Sends the NMT state every 1017 ms.

    send(data) sends a message of the error control protocol. before_answer: the first heartbeat
    after a write of 1017 is sent before SDO answers, otherwise after it. first_ns: from the boot to
    the first heartbeat, 0 = the time of 1017.
    """

    objects: ClassVar[tuple[int, ...]] = (PRODUCER_TIME,)

    def __init__(
        self,
        store: ObjectStore,
        clock: Clock,
        send: Callable[[bytes], None],
        state: Callable[[], int],
        *,
        before_answer: bool = False,
        first_ns: TimeNs = 0,
    ) -> None:
        self._store, self._clock, self._send, self._state = store, clock, send, state
        self._before_answer, self._first_ns = before_answer, first_ns
        self._run = 0  # counts the starts: an event of an older one does nothing

    def boot_up(self, *, is_said: bool = True) -> None:
        """Send the boot-up message, if it is to be said; it counts as the first heartbeat."""
        if is_said:
            self._send(BOOT_UP)
        self._start(self._clock.now_ns + (self._first_ns or self._period_ns))

    def stop(self) -> None:
        """Send no more."""
        self._run += 1

    @property
    def is_active(self) -> bool:
        """Whether heartbeats are sent, that is whether there is no node guarding."""
        return self._store.value(PRODUCER_TIME) > 0

    @property
    def _period_ns(self) -> TimeNs:
        return self._store.value(PRODUCER_TIME) * MS

    def written(self, index: int, sub: int, value: int) -> None:
        """Begin anew at once."""
        first_ns = self._clock.now_ns
        if self._before_answer and self.is_active:
            self._send(bytes((self._state(),)))
            first_ns += self._period_ns
        self._start(first_ns)

    def _start(self, first_ns: TimeNs) -> None:
        self._run += 1
        if self.is_active:
            self._plan(self._run, first_ns)

    def _plan(self, run: int, time_ns: TimeNs) -> None:
        self._clock.call_at(time_ns, Phase.APPLICATION, partial(self._beat, run))

    def _beat(self, run: int) -> None:
        if run == self._run:
            self._plan(run, self._clock.now_ns + self._period_ns)
            self._send(bytes((self._state(),)))


class HeartbeatConsumer(Owner):
    """Watches the heartbeats of other nodes as 1016 says: node number and time in ms per entry.

    A node is watched from its first heartbeat on. lost(node), found(node): its heartbeat is late,
    or it has booted while it was watched; it is there again.
    """

    objects: ClassVar[tuple[int, ...]] = (CONSUMER_TIME,)

    def __init__(
        self,
        store: ObjectStore,
        clock: Clock,
        network: SimNetwork,
        lost: Callable[[int], None],
        found: Callable[[int], None],
    ) -> None:
        self._store, self._clock, self._network = store, clock, network
        self._lost, self._found = lost, found
        self._watched: list[tuple[int, Callable[..., None], Timer]] = []

    def start(self) -> None:
        """Watch what the entries say from now on."""
        self.stop()
        for sub in self._subs:
            node, time_ns = _entry(self._store.value(CONSUMER_TIME, sub))
            if time_ns:
                timer = Timer(self._clock, partial(self._lost, node))
                handler = partial(self._on_heartbeat, node, time_ns, timer)
                self._network.subscribe(ERROR_CONTROL_BASE + node, handler)
                self._watched.append((node, handler, timer))

    def stop(self) -> None:
        """Watch nobody."""
        for node, handler, timer in self._watched:
            timer.stop()
            self._network.unsubscribe(ERROR_CONTROL_BASE + node, handler)
        self._watched.clear()

    def check(self, index: int, sub: int, value: int) -> None:
        """A node is watched by one entry only; bits 24 to 31 are reserved."""
        if value >> 24:
            abort(AbortCode.INVALID_VALUE)
        node, time_ns = _entry(value)
        others = (self._store.value(index, other) for other in self._subs if other != sub)
        if time_ns and any(_entry(other)[0] == node and _entry(other)[1] for other in others):
            abort(AbortCode.INCOMPATIBLE)

    def written(self, index: int, sub: int, value: int) -> None:
        """Take the entries anew; who is watched no more is missed no more."""
        before = {node for node, *_ in self._watched}
        self.start()
        for node in sorted(before - {node for node, *_ in self._watched}):
            self._found(node)

    @property
    def _subs(self) -> range:
        return range(1, self._store.value(CONSUMER_TIME, 0) + 1)

    def _on_heartbeat(
        self, node: int, time_ns: TimeNs, timer: Timer, _id: int, data: bytearray, _timestamp: float
    ) -> None:
        if len(data) != 1:
            return
        if data != BOOT_UP:
            timer.start(time_ns)
            self._found(node)
        elif timer.is_running:
            timer.stop()
            self._lost(node)


@dataclass(frozen=True)
class GuardingEvents:
    """lost(): the life time (100C times 100D) has passed without a request. found(): one has come
    again. is_off(): heartbeats are sent instead.
    """

    lost: Callable[[], None]
    found: Callable[[], None]
    is_off: Callable[[], bool]


class NodeGuarding(Owner):
    """Answers the remote requests of a master and watches that they come.

    send(data) sends the answer. state: the NMT state of the node.
    """

    objects: ClassVar[tuple[int, ...]] = (GUARD_TIME, LIFE_TIME_FACTOR)

    def __init__(
        self,
        store: ObjectStore,
        clock: Clock,
        network: SimNetwork,
        send: Callable[[bytes], None],
        state: Callable[[], int],
        events: GuardingEvents,
    ) -> None:
        self._store, self._network, self._send, self._state = store, network, send, state
        self._events = events
        self._timer = Timer(clock, events.lost)
        self._toggle = 0
        self._can_id: int | None = None

    def start(self, node_id: int) -> None:
        """Listen; the first answer has toggle bit 0."""
        self._can_id = ERROR_CONTROL_BASE + node_id
        self._toggle = 0
        self._network.subscribe_remote(self._can_id, self._on_request)

    def stop(self) -> None:
        """Forget the master."""
        self._timer.stop()
        if self._can_id is not None:
            self._network.unsubscribe_remote(self._can_id, self._on_request)
            self._can_id = None

    def _on_request(self) -> None:
        if self._events.is_off():
            return
        self._send(bytes((self._toggle | self._state(),)))
        self._toggle ^= TOGGLE
        self._events.found()
        self._watch()

    def written(self, index: int, sub: int, value: int) -> None:
        """Take a new life time into account; without one nobody is missed."""
        if not self._life_ns:
            self._events.found()
        if self._timer.is_running:
            self._watch()

    @property
    def _life_ns(self) -> TimeNs:
        return self._store.value(GUARD_TIME) * self._store.value(LIFE_TIME_FACTOR) * MS

    def _watch(self) -> None:
        if self._life_ns:
            self._timer.start(self._life_ns)
        else:
            self._timer.stop()


def _entry(value: int) -> tuple[int, TimeNs]:
    """Return node number and time of an entry of 1016; time 0 for one that is not used."""
    node, time_ms = value >> 16 & 0xFF, value & 0xFFFF
    return (node, time_ms * MS) if 1 <= node <= NODE_ID_MAX else (node, 0)
