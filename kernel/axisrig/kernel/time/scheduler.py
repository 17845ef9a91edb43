"""The one clock of a simulated run: an event queue in integer nanoseconds.

Events run in the order (time, phase, call order). Nothing else decides, so a run with the same
inputs is the same run. One thread drives it; an action that waits would advance time inside an
instant and is refused.
"""

from collections.abc import Callable
from heapq import heappop, heappush
from itertools import count
from typing import Any, TypeAlias, cast

from axisrig.kernel.time.clock import TimeNs

native: Any  # both ways through what asks for it are checked
try:  # of the compiled build
    from axisrig.kernel.time import _scheduler

    native = _scheduler
except ImportError:
    native = None

Event: TypeAlias = Any
"""Handle of `call_at`; only the scheduler looks into it.

Here it is the list [time_ns, phase, sequence, action]; the action is None once cancelled. A plain
list because it is its own heap entry: the sequence is unique, so comparing two entries never
reaches the action.
"""


class Scheduler:
    """The simulated clock (`axisrig.kernel.time.clock.Clock`); starts at 0 ns.

    now_ns: current simulated time, set here only. No property, for it is read twenty times a cycle.
    """

    def __init__(self) -> None:
        self.now_ns: TimeNs = 0
        self._events: list[Event] = []
        self._sequence = count()
        self._advancing = _Advancing()

    @property
    def running(self) -> bool:
        """Whether an action is being run, that is whether waiting is refused."""
        return self._advancing.is_on

    def call_at(self, time_ns: TimeNs, phase: int, action: Callable[[], object], /) -> Event:
        """Run `action` at `time_ns` in `phase`; return the handle that `cancel` takes.

        An earlier phase of the current instant is allowed: it runs next.
        Raises ValueError when `time_ns` is before now (a defect of the caller).
        """
        if time_ns < self.now_ns:
            raise ValueError(f"call_at({time_ns} ns) is before now ({self.now_ns} ns)")
        event = [time_ns, phase, next(self._sequence), action]
        heappush(self._events, event)
        return event

    def cancel(self, event: Event) -> None:
        """Forget `event`; without effect when it has already run."""
        event[3] = None

    def run_until(self, time_ns: TimeNs) -> None:
        """Run every event up to and including `time_ns`; now is `time_ns` afterwards.

        An exception of an action stops the clock at that action's time and passes through.
        Raises RuntimeError when called from an action, ValueError for a time before now.
        """
        if time_ns < self.now_ns:
            raise ValueError(f"run_until({time_ns} ns) is before now ({self.now_ns} ns)")
        events = self._events
        with self._advancing:
            while events:
                due_ns, _, _, action = events[0]
                if due_ns > time_ns:
                    break
                heappop(events)
                if action is not None:
                    self.now_ns = due_ns
                    action()
            self.now_ns = time_ns

    def run_while(self, condition: Callable[[], bool], timeout_ns: TimeNs | None) -> bool:
        """Advance event by event while `condition()` holds.

        Return True once it no longer holds (now = time of the event that ended it), False when
        `timeout_ns` has passed since the call (now = start + timeout; events of that instant have
        run). None waits without limit.
        Raises RuntimeError when called from an action, and when a wait without limit has no event
        left that could end it.
        """
        events = self._events
        end_ns = None if timeout_ns is None else self.now_ns + timeout_ns
        with self._advancing:
            while condition():
                if end_ns is None and not events:
                    raise RuntimeError("waiting without limit and no event is pending")
                if end_ns is not None and (not events or events[0][0] > end_ns):
                    self.now_ns = end_ns
                    return False
                event = heappop(events)
                action = event[3]
                if action is not None:
                    self.now_ns = event[0]
                    action()
        return True


class _Advancing:
    """Marks that time is being advanced; only one caller can do so.

    Entered every simulated millisecond, and a generator would cost three times as much.
    """

    def __init__(self) -> None:
        self.is_on = False

    def __enter__(self) -> None:
        if self.is_on:
            raise RuntimeError(
                "simulated time is already advancing: an event action must not wait; "
                "send the request and go on in a later event"
            )
        self.is_on = True

    def __exit__(self, *_: object) -> None:
        self.is_on = False


def new_scheduler() -> Scheduler:
    """Make a simulated clock, in C where this build has it (`_scheduler.c`)."""
    return cast(Scheduler, native.Scheduler()) if native is not None else Scheduler()


def is_native(scheduler: Scheduler) -> bool:
    """Whether a scheduler is the one in C."""
    return native is not None and isinstance(scheduler, native.Scheduler)
