"""Simulated time tied to real time: the same scheduler, which waits and listens to the outside.

Before the first event of an instant the loop waits until real time has come there. While it waits
it polls the interfaces, in this one thread; a frame becomes an event at the instant it was seen,
and never later than the event that it came before. The clock of real time is a function that the
command line hands down, so tests drive it with one of their own.

Late is late: an event keeps its instant of simulated time. When an instant is missed by more than
`slip_ns`, the plan of the run moves by it, so that SYNCs never come in bursts: a drive that
interpolates would make a jump of one.
"""

import heapq
from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

from axisrig.bench.bus.deadlines import Deadlines
from axisrig.kernel.time.clock import MS, US, Phase, S, TimeNs
from axisrig.kernel.time.scheduler import Event, Scheduler

SPIN_NS = 200 * US
"""So long before an instant the loop no longer sleeps: a sleep ends some 60 us late on Linux."""
SHARE_S = 200e-6
"""Time that one of several interfaces may be listened to before the next has its turn."""
LISTEN_NS = 5 * MS
BATCH = 256
FREE_NS = 200 * MS
"""So long without a SYNC the drives' time goes on by real time again."""

Arrival = tuple[bool, Callable[[], object]]
"""A frame from outside: whether it is the SYNC, and what delivers it."""


class Source(Protocol):
    """An interface to the outside."""

    @property
    def is_waiting(self) -> bool:
        """Whether answers to the last SYNC are still to come."""
        ...

    def receive(self, timeout_s: float) -> Arrival | None:
        """Wait up to `timeout_s` for the next frame."""
        ...


@dataclass(frozen=True)
class RealTime:
    """Real time, as the command line hands it down.

    monotonic_ns: a clock that never goes back, ns from anywhere. pause: waits for so many seconds.
    """

    monotonic_ns: Callable[[], TimeNs]
    pause: Callable[[float], None]


@dataclass(frozen=True)
class Pacing:
    """How simulated time follows real time.

    slip_ns: an instant missed by more than this moves the plan. wait_ns: how long a cycle waits
    for the answers of drives that are slower than `answer_ns` after the SYNC; 0 = not at all.
    sync_period_ns: gives the period by which each SYNC from outside advances the time, None =
    time is real time.
    """

    slip_ns: TimeNs
    wait_ns: TimeNs = 0
    answer_ns: TimeNs = 0
    sync_period_ns: Callable[[], TimeNs] | None = None


class PacedScheduler(Scheduler):
    """A scheduler whose events happen at their instant of real time, or late.

    Instant 0 is the first wait: what is built before takes no time of the run.
    """

    def __init__(self, real_time: RealTime, pacing: Pacing, deadlines: Deadlines) -> None:
        super().__init__()
        self.monotonic_ns, self.pause = real_time.monotonic_ns, real_time.pause
        self.pacing, self.deadlines = pacing, deadlines
        self._answers_due_ns: TimeNs | None = None
        self._sources: tuple[Source, ...] = ()
        self._origin_ns: TimeNs | None = None
        self._planned_ns: TimeNs = 0
        self._arrived_ns: TimeNs = 0
        self._waits_ns = self._noted_ns = -1
        self._sync_ns: TimeNs | None = None

    def listen(self, source: Source) -> None:
        """Poll this interface from now on."""
        self._sources += (source,)

    def sync_sent(self) -> None:
        """Note that the SYNC of this instant is out; what it was late counts, and may slip.

        Of several segments the first one counts.
        """
        origin_ns, sent_ns = self._origin(), self.monotonic_ns()
        if self._noted_ns != self.now_ns:
            self._noted_ns = self.now_ns
            self.deadlines.sync_sent(self._planned_ns, sent_ns)
        late_ns = sent_ns - origin_ns - self.now_ns
        if late_ns > self.pacing.slip_ns:  # else the next one would follow at once
            self._origin_ns = origin_ns + late_ns
            self.deadlines.slipped(late_ns)
        self._answers_due_ns = self.now_ns + self.pacing.answer_ns

    @property
    def real_ns(self) -> TimeNs:
        """Present real time, in the time of the run."""
        return self.monotonic_ns() - self._origin()

    def _origin(self) -> TimeNs:
        """Real time of instant 0."""
        if self._origin_ns is None:
            self._planned_ns = self.monotonic_ns()
            self._origin_ns = self._planned_ns - self.now_ns
        return self._origin_ns

    def run_until(self, time_ns: TimeNs) -> None:
        """As `Scheduler.run_until`, in real time."""
        if time_ns < self.now_ns:
            raise ValueError(f"run_until({time_ns} ns) is before now ({self.now_ns} ns)")
        with self._advancing:
            while (event := self._next(time_ns)) is not None:
                self._run(event)
            self.now_ns = time_ns

    def run_while(self, condition: Callable[[], bool], timeout_ns: TimeNs | None) -> bool:
        """As `Scheduler.run_while`, in real time; a wait without limit may end by a frame."""
        end_ns = None if timeout_ns is None else self.now_ns + timeout_ns
        with self._advancing:
            while condition():
                event = self._next(end_ns)
                if event is not None:
                    self._run(event)
                elif end_ns is None:
                    self.now_ns += LISTEN_NS  # nothing is planned: time passes all the same
                else:
                    self.now_ns = end_ns
                    return False
        return True

    def _run(self, event: Event) -> None:
        self.now_ns = event[0]
        event[3]()

    def _next(self, end_ns: TimeNs | None) -> Event | None:
        """Wait for the next event and take it; None when `end_ns` (or a while) came first."""
        events = self._events
        while True:
            while events and events[0][3] is None:
                heapq.heappop(events)
            has_event = bool(events) and (end_ns is None or events[0][0] <= end_ns)
            limit_ns = self.now_ns + LISTEN_NS if end_ns is None else end_ns
            target_ns = events[0][0] if has_event else limit_ns
            # What has arrived is let in at once, whatever real time has become
            if target_ns > max(self.now_ns, self._arrived_ns) and self._wait(target_ns):
                continue  # frames came: look again what is next
            return heapq.heappop(events) if has_event else None

    # --- waiting ---------------------------------------------------------------------------------

    def _wait(self, target_ns: TimeNs) -> bool:
        """Wait for an instant; return True, before it has come, when frames were received."""
        timeout_s = 0.0
        while not self._take(target_ns, timeout_s):
            is_held = self._is_held(target_ns)
            left_ns = target_ns - self.real_ns
            if is_held:
                timeout_s = LISTEN_NS / S
            elif left_ns > 0:
                timeout_s = max(left_ns - SPIN_NS, 0) / S
            elif self._lacks_answers(target_ns, -left_ns):
                timeout_s = SPIN_NS / S
            elif -left_ns > SPIN_NS and self._take(target_ns, 0.0):
                break  # they came while the computer was away, before what is late
            else:
                self._reach(target_ns, -left_ns)
                return False
        return True

    def _lacks_answers(self, target_ns: TimeNs, late_ns: TimeNs) -> bool:
        """Whether the cycle at `target_ns` should wait on for the answers of the drives."""
        if self._answers_due_ns is None or target_ns < self._answers_due_ns:
            return False
        if late_ns >= self.pacing.wait_ns or not any(s.is_waiting for s in self._sources):
            self._answers_due_ns = None  # until the next SYNC
            return False
        self._waits_ns = target_ns
        return True

    def _reach(self, target_ns: TimeNs, late_ns: TimeNs) -> None:
        """Note that an instant has come, and move the plan by what must not be made good."""
        if self._waits_ns == target_ns and late_ns > SPIN_NS:
            self.deadlines.waited(late_ns)
        elif late_ns > self.pacing.slip_ns:
            self.deadlines.slipped(late_ns)
        else:
            late_ns = 0
        self._planned_ns = self._origin() + target_ns
        self._origin_ns = self._origin() + late_ns

    # --- frames from outside ---------------------------------------------------------------------

    def _take(self, target_ns: TimeNs, timeout_s: float) -> bool:
        """Plan what has arrived, listening up to `timeout_s`; return whether anything has."""
        if len(self._sources) > 1:
            timeout_s = min(timeout_s, SHARE_S)
        has_any = False
        for source in self._sources:
            arrival = source.receive(timeout_s)
            for _ in range(BATCH):
                if arrival is None:
                    break
                has_any, timeout_s = True, 0.0
                self._plan(arrival, target_ns)
                arrival = source.receive(0.0)
            else:
                if arrival is not None:
                    self._plan(arrival, target_ns)
        return has_any

    def _plan(self, arrival: Arrival, target_ns: TimeNs) -> None:
        is_sync, action = arrival
        time_ns = max(min(self.real_ns, target_ns - 1), self._arrived_ns, self.now_ns)
        if self._sync_ns is not None or is_sync:
            time_ns = self._follow(time_ns, is_sync)
        self._arrived_ns = time_ns
        self.call_at(time_ns, Phase.DELIVERY, action)

    # --- time by SYNC ----------------------------------------------------------------------------

    def _follow(self, time_ns: TimeNs, is_sync: bool) -> TimeNs:
        """Return the instant of an arrival where each SYNC is one period after the last."""
        period_ns = self.pacing.sync_period_ns() if self.pacing.sync_period_ns else 0
        if not period_ns:
            self._sync_ns = None
            return time_ns
        if self._sync_ns is None:
            self._sync_ns = time_ns
            return time_ns
        next_ns = self._sync_ns + period_ns
        if not is_sync:  # it comes before the next SYNC, however late that is
            return max(min(time_ns, next_ns - 1), self._arrived_ns, self.now_ns)
        self._sync_ns = max(next_ns, self._arrived_ns, self.now_ns)
        self._origin_ns = self.monotonic_ns() - self._sync_ns
        return self._sync_ns

    def _is_held(self, target_ns: TimeNs) -> bool:
        """Whether `target_ns` has to wait for the next SYNC."""
        if self._sync_ns is None or self.pacing.sync_period_ns is None:
            return False
        next_ns = self._sync_ns + self.pacing.sync_period_ns()
        if target_ns < next_ns:
            return False
        if self.real_ns - next_ns < FREE_NS:
            return True
        self._sync_ns = None
        self._origin_ns = self.monotonic_ns() - next_ns
        return False
