"""From when to when a fault acts."""

from axisrig.kernel.time.clock import TimeNs


class Span:
    """From its begin on until its end; both are None as long as they have not come."""

    def __init__(self) -> None:
        self.begin_ns: TimeNs | None = None
        self.end_ns: TimeNs | None = None

    def holds(self, time_ns: TimeNs) -> bool:
        """Whether it acts at an instant that is past."""
        if self.begin_ns is None or time_ns < self.begin_ns:
            return False
        return self.end_ns is None or time_ns < self.end_ns
