"""What is kept of the traffic of one segment: every frame for its records, and the load."""

from collections.abc import Sequence

import can

from axisrig.bench.bus.can.frame import Frame, FrameObserver
from axisrig.bench.bus.can.load import LoadMeter, LoadNow
from axisrig.bench.bus.can.simbus import message
from axisrig.bench.bus.journal import Entry, Journal
from axisrig.kernel.time.clock import TimeNs


class Traffic:
    """Gives every frame of a segment to its journal and its observers, and adds up the load.

    name: of the segment. journal: takes every frame at its end, for records that may see it later.
    observers: called at every end of frame. passed: of the load (`LoadMeter`).
    """

    def __init__(self, name: str, bitrate: int, journal: Journal) -> None:
        self.name = name
        self.observers: list[FrameObserver] = []
        self.journal = journal
        self._meter = LoadMeter(bitrate)
        self.passed = self._meter.passed
        journal.add(self._settle)

    def _settle(self, _block: Sequence[Entry]) -> None:
        """Add up the load together with the records, so that neither grows."""
        self._meter.settle()

    def tap(self, listener: can.Listener) -> None:
        """Give `listener` a copy of every frame at its end, dropped and error frames included.

        Loggers of python-can work as they are; the one who opened it stops it. An error frame
        carries the identifier of the frame it destroyed. For BLF take
        `axisrig.bench.bus.can.logs.blf_writer`."""

        def give(time_ns: TimeNs, name: str, frame: Frame, is_error: bool) -> None:
            listener.on_message_received(message(frame, time_ns, name, is_error=is_error))

        self.observe(give)

    def observe(self, observer: FrameObserver) -> None:
        """Call `observer(time_ns, name, frame, is_error)` at once for what `tap` would get."""
        self.observers.append(observer)

    def busy_bits(self, window_ns: TimeNs) -> list[int]:
        """Return the busy bits of each window since 0; `window_ns` is a multiple of 1 ms."""
        return self._meter.busy_bits(window_ns)

    def load_now(self, until_ns: TimeNs, span_ns: TimeNs) -> LoadNow:
        """Return what was carried until now, with the load of the last `span_ns`."""
        return self._meter.now(until_ns, span_ns)

    def record(self, frame: Frame, time_ns: TimeNs, *, is_error: bool) -> None:
        """Give a frame to the records before anyone reacts to it."""
        journal = self.journal
        journal.entries.append((time_ns, self.name, frame, is_error))
        if len(journal.entries) >= journal.block_frames:
            journal.drain()
        for observer in self.observers:
            observer(time_ns, self.name, frame, is_error)
