"""Conditions that must hold for a time, looked at from tick to tick."""

from axisrig.kernel.time.clock import MS, TimeNs


class HoldTime:
    """A condition and since when it holds. since_ns: None = it does not."""

    __slots__ = ("since_ns",)

    def __init__(self) -> None:
        self.since_ns: TimeNs | None = None

    def holds(self, now_ns: TimeNs, condition: bool, time_ms: int) -> bool:
        """Note the condition now; return whether it has held for `time_ms` at least."""
        if not condition:
            self.since_ns = None
            return False
        if self.since_ns is None:
            self.since_ns = now_ns
        return now_ns - self.since_ns >= time_ms * MS
