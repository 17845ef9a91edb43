"""One measurement run of any measuring type that ends by a signal.

The run is a small state machine that is evaluated once per NC cycle with this cycle's values:

    CLEARING    latch control word 0 until no drive shows an enabled probe or a stored edge; so a
                latch of an earlier run can never be taken for one of this run
    ARMING      latch control word set until every drive has acknowledged
    MOVING      the path is travelled; the first stored edge of any axis deletes the distance to go,
                unless the run goes on to its target (type 3 with G106)
    COLLECTING  the axes rest; it is waited for what shows whether an edge came before they had
                come to rest (`latest_edge.py`). Then every measuring axis must deliver a value that
                is proved, and confirm it by SDO
    DONE        results are final

It touches the machine through `LatchPort` only, one per measuring axis: the latch in a drive
(P-AXIS-00516 = DRIVE) is one, a signal of the PLC (`kernel.channel.probing`) another.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from enum import Enum, auto
from typing import Final, Protocol

from axisrig.kernel.errors import Alarm
from axisrig.kernel.measuring.dead_time import DeadTime
from axisrig.kernel.measuring.fixed_stop.record import FixedStopRecord
from axisrig.kernel.measuring.latest_edge import LatestEdge, StatusPort
from axisrig.kernel.time.clock import TimeNs

# Cycles that the proof of a value may take once the edge is reported and the axes rest
PROOF_CYCLES_MAX: Final = 16
# Cycles that a drive may take to send counter and latch by SDO: some answer after tens of ms
CHECK_CYCLES_MAX: Final = 200


class LatchPort(StatusPort, Protocol):
    """The latch of one measuring axis.

    latched_speed_mm: travel of the axis in one cycle at the speed that it had at the latch.
    doubt_mm: how far a confirmed value may be wrong, None where it is proved.
    """

    @property
    def name(self) -> str: ...  # noqa: D102
    @property
    def is_clear(self) -> bool: ...  # noqa: D102
    @property
    def is_armed(self) -> bool: ...  # noqa: D102
    @property
    def latched_speed_mm(self) -> float: ...  # noqa: D102
    @property
    def doubt_mm(self) -> float | None: ...  # noqa: D102
    @property
    def is_actuated(self) -> bool | None: ...  # noqa: D102
    @property
    def is_prepared(self) -> bool: ...  # noqa: D102

    def arm(self) -> None: ...  # noqa: D102
    def disarm(self) -> None: ...  # noqa: D102
    def is_confirmed(self) -> bool: ...  # noqa: D102


class RunState(Enum):
    """The phase of a measurement run; see the module text."""

    CLEARING = auto()
    ARMING = auto()
    MOVING = auto()
    COLLECTING = auto()
    DONE = auto()


class Order(Enum):
    """What the run asks of the motion in this cycle; RELAX: go to the places that the run gives."""

    NONE = auto()
    START = auto()
    BRAKE = auto()
    RELAX = auto()


@dataclass
class RunRecord:
    """What a finished run delivers and when things happened (cycle instants, ns).

    axes: the measuring axes. latched_mm: measured position per axis, ACS; empty without signal.
    block: NC block for messages. signal_ns: cycle in which the first stored edge was seen.
    goes_on: the signal does not end the motion. inputs: probing input in use per axis. sources:
    where the signal of each axis comes from, P-AXIS-00516. doubt_mm: how far a value may be wrong,
    of those that are not proved. fixed_stop: of a run to a fixed stop, whose signal is that the
    stop is found.
    """

    axes: tuple[str, ...]
    block: str = ""
    goes_on: bool = False
    inputs: dict[str, int] = field(default_factory=dict)
    sources: dict[str, str] = field(default_factory=dict)
    begin_ns: TimeNs = 0
    start_ns: TimeNs | None = None
    signal_ns: TimeNs | None = None
    end_ns: TimeNs | None = None
    latched_mm: dict[str, float] = field(default_factory=dict)
    doubt_mm: dict[str, float] = field(default_factory=dict)
    fixed_stop: FixedStopRecord | None = None

    @property
    def has_signal(self) -> bool:
        """Whether every measuring axis has delivered a value."""
        return len(self.latched_mm) == len(self.axes)


class MeasuringRun:
    """Evaluates one run; `evaluate` is called once per cycle until `state` is DONE.

    ports: one latch per measuring axis. error_no_signal: alarm when no signal comes. goes_on: the
    signal does not brake. dead_times: of axes whose probe signals too late (P-AXIS-00487); the
    measured value is led back at the speed of the latch, so that an acceleration a leaves
    a t^2 / 2. A value that cannot be led back is dropped, and warn gets its alarm (900520).
    Raises Alarm 50052 (probe actuated before the run), 900001 (latch without value), 900002 (drive
    does not acknowledge), 900003 (only some axes signalled), 900004 (no signal),
    900009 (stale latch), 900082 (switched off on the way),
    900083 (not confirmed by SDO).
    """

    def __init__(
        self,
        ports: Sequence[LatchPort],
        block: str,
        now_ns: TimeNs,
        error_no_signal: bool,
        *,
        goes_on: bool = False,
        dead_times: Mapping[str, DeadTime] | None = None,
        warn: Callable[[Alarm], None] | None = None,
    ) -> None:
        self._ports = tuple(ports)
        self._edges = {port.name: LatestEdge(port, now_ns) for port in ports}
        self._error_no_signal = error_no_signal
        self._dead_times, self._warn = dead_times or {}, warn
        self._refused: set[str] = set()
        self._waited = 0
        self.state = RunState.CLEARING
        self.record = RunRecord(
            tuple(p.name for p in ports), block, goes_on=goes_on, begin_ns=now_ns
        )
        self._rest_ns: TimeNs | None = None
        self._steps: dict[RunState, Callable[[TimeNs, bool], Order]] = {
            RunState.CLEARING: self._clearing,
            RunState.ARMING: self._arming,
            RunState.MOVING: self._moving,
            RunState.COLLECTING: self._collecting,
        }
        self._check_not_actuated()
        for port in ports:
            port.disarm()

    def _check_not_actuated(self) -> None:
        for port in self._ports:
            if port.is_actuated:
                raise Alarm(50052, axis=port.name)

    @property
    def is_done(self) -> bool:
        """Whether the results are final."""
        return self.state is RunState.DONE

    def evaluate(self, now_ns: TimeNs, is_standing: bool, rest_ns: TimeNs | None) -> Order:
        """Advance the run with this cycle's values.

        is_standing: the interpolation has ended and every axis is within its exact-stop window.
        rest_ns: the SYNC in which the measuring axes came to rest there, None before that.
        """
        self._rest_ns = rest_ns
        step = self._steps.get(self.state)
        return step(now_ns, is_standing) if step else Order.NONE

    def abort(self) -> None:
        """End without a result: every probe is switched off, and what some axes have is dropped."""
        for port in self._ports:
            port.disarm()
        if not self.is_done:
            self.record.latched_mm.clear()
        self._enter(RunState.DONE)

    def _enter(self, state: RunState) -> None:
        self.state, self._waited = state, 0

    def _wait_for_handshake(self, alarm_id: int, port: LatchPort) -> None:
        cycles_max = port.arrival.handshake_cycles
        if cycles_max is None:
            self._waited = 0
        else:
            self._wait(alarm_id, port, cycles_max)

    def _wait(self, alarm_id: int, port: LatchPort, cycles_max: int) -> None:
        self._waited += 1
        if self._waited > cycles_max:
            raise Alarm(alarm_id, axis=port.name, cycles=self._waited - 1)

    def _clearing(self, _now_ns: TimeNs, _is_standing: bool) -> Order:
        for port in self._ports:
            if not port.is_clear:
                self._wait_for_handshake(900009, port)
                return Order.NONE
        for port in self._ports:
            port.arm()
        self._enter(RunState.ARMING)
        return Order.NONE

    def _arming(self, now_ns: TimeNs, _is_standing: bool) -> Order:
        for port in self._ports:
            if not port.is_armed:
                self._wait_for_handshake(900002, port)
                return Order.NONE
            if not port.is_prepared:
                self._wait(900083, port, CHECK_CYCLES_MAX)
                return Order.NONE
        self._check_not_actuated()
        self.record.start_ns = now_ns
        self._enter(RunState.MOVING)
        return Order.START

    def _check_still_armed(self) -> None:
        for port in self._ports:
            if not port.is_armed:
                raise Alarm(900082, axis=port.name)

    def _moving(self, now_ns: TimeNs, is_standing: bool) -> Order:
        self._check_still_armed()
        if self._is_first_signal(now_ns) and not self.record.goes_on:
            return Order.BRAKE
        if is_standing:
            self._enter(RunState.COLLECTING)
            return self._collecting(now_ns, is_standing)
        return Order.NONE

    def _is_first_signal(self, now_ns: TimeNs) -> bool:
        """Judge the edges of this cycle; whether one of them is the first that counts."""
        for edge in self._edges.values():
            edge.look(now_ns, self._rest_ns)
        if self.record.signal_ns is None and any(e.counts for e in self._edges.values()):
            self.record.signal_ns = now_ns
            for dead_time in self._dead_times.values():
                dead_time.note_signal()
            return True
        return False

    def _collecting(self, now_ns: TimeNs, _is_standing: bool) -> Order:
        self._check_still_armed()
        self._is_first_signal(now_ns)
        for port in self._ports:
            value = port.latched_mm
            is_wanted = self._is_wanted(port.name) and self._edges[port.name].counts
            if value is not None and is_wanted and port.is_confirmed():
                self._take(port, value)
        if not any(self._is_wanted(port.name) for port in self._ports):
            if self._refused and self._error_no_signal:
                raise Alarm(900004, axis=" ".join(sorted(self._refused)))
            return self._finish(now_ns)
        if any(e.is_open and not e.waits_for_stamp for e in self._edges.values()):
            return Order.NONE  # an edge may still be reported
        late = self._without_proof()
        if late:
            self._waited += 1
            is_proved = all(self._is_proved(port) for port in late)
            if self._waited <= (CHECK_CYCLES_MAX if is_proved else PROOF_CYCLES_MAX):
                return Order.NONE
        self._judge_missing()
        return self._finish(now_ns)

    def _is_wanted(self, axis: str) -> bool:
        return axis not in self.record.latched_mm and axis not in self._refused

    def _take(self, port: LatchPort, value_mm: float) -> None:
        dead_time = self._dead_times.get(port.name)
        if dead_time is not None:
            try:
                value_mm = dead_time.led_back_mm(value_mm, port.latched_speed_mm)
            except Alarm as alarm:
                self._refused.add(port.name)
                if self._warn is not None:
                    self._warn(alarm)
                return
        self.record.latched_mm[port.name] = value_mm
        if port.doubt_mm is not None:
            self.record.doubt_mm[port.name] = port.doubt_mm

    def _without_proof(self) -> list[LatchPort]:
        """Return the latches whose edge is reported, and its value or its time not proved."""
        return [
            port
            for port in self._ports
            if self._is_wanted(port.name) and not self._edges[port.name].is_over
        ]

    def _is_proved(self, port: LatchPort) -> bool:
        return port.latched_mm is not None and self._edges[port.name].counts

    def _judge_missing(self) -> None:
        """Values are missing for good: report which of the four reasons it is."""
        late = sorted(self._without_proof(), key=self._is_proved)  # without any proof first
        if late:
            alarm_id = 900083 if self._is_proved(late[0]) else 900001
            raise Alarm(alarm_id, axis=late[0].name, cycles=self._waited - 1)
        signalled = [p for p in self._ports if self._edges[p.name].counts]
        silent = [p.name for p in self._ports if not self._edges[p.name].counts]
        if signalled:
            others = " ".join(p.name for p in signalled)
            raise Alarm(900003, axis=" ".join(silent), others=others)
        if self._error_no_signal:
            raise Alarm(900004, axis=" ".join(silent))

    def _finish(self, now_ns: TimeNs) -> Order:
        for port in self._ports:
            port.disarm()
        self.record.end_ns = now_ns
        self._enter(RunState.DONE)
        return Order.NONE
