"""A time-out that is set anew again and again, without a clock event each time."""

from collections.abc import Callable

from axisrig.kernel.time.clock import Clock, Phase, TimeNs


class Timer:
    """Calls `action` once the deadline given last has passed.

    Moving the deadline out costs an assignment: the event that is under way looks at it when it
    comes. An action may start its timer again.
    """

    __slots__ = ("_action", "_clock", "_deadline_ns", "_event_ns")

    def __init__(self, clock: Clock, action: Callable[[], None]) -> None:
        self._clock, self._action = clock, action
        self._deadline_ns: TimeNs | None = None
        self._event_ns: TimeNs | None = None  # when the one event that counts comes

    @property
    def is_running(self) -> bool:
        """Whether a deadline is set."""
        return self._deadline_ns is not None

    def start(self, delay_ns: TimeNs) -> None:
        """Let the action come `delay_ns` from now, instead of what was set before."""
        deadline_ns = self._clock.now_ns + delay_ns
        self._deadline_ns = deadline_ns
        if self._event_ns is None or self._event_ns > deadline_ns:
            self._plan(deadline_ns)

    def stop(self) -> None:
        """Let no action come."""
        self._deadline_ns = None

    def _plan(self, time_ns: TimeNs) -> None:
        self._event_ns = time_ns
        self._clock.call_at(time_ns, Phase.APPLICATION, lambda: self._look(time_ns))

    def _look(self, planned_ns: TimeNs) -> None:
        if planned_ns != self._event_ns:
            return  # an earlier deadline came meanwhile and took an event of its own
        self._event_ns = None
        if self._deadline_ns is None:
            return
        if self._deadline_ns > self._clock.now_ns:
            self._plan(self._deadline_ns)
            return
        self._deadline_ns = None
        self._action()
