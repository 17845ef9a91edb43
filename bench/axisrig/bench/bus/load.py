"""Load of one segment: how long it was busy per window, and how long frames waited.

Busy counts from SOF to the end of the intermission, so 100 % is a bus on which nothing more fits.
"""

from array import array
from collections.abc import Iterable
from dataclasses import dataclass

from axisrig.bench.bus.frame import Frame
from axisrig.bench.bus.native import native_records
from axisrig.kernel.time.clock import MS, S, TimeNs

WINDOW_NS = MS
"""Resolution of the record; longer windows are sums of these."""

EXTENDED_FLAG = 0x8000_0000
"""Set on 29-bit identifiers used as keys, as in SocketCAN and BLF."""


@dataclass(frozen=True)
class LoadFigures:
    """Load of a segment from 0 to `until_ns`.

    busy_bits: total, the most in any ms, and in any 100 of them in a row. busy_share: 0..1 of the
    time. worst_100ms_share: 0..1 of those 100 ms, or of the whole time where that is shorter.
    worst_delay_ns: per identifier (bit 31 set on 29-bit ones) the longest time from the request
    to the start of the attempt that got through, ascending by identifier; for what still waits the
    time until now.
    """

    until_ns: TimeNs
    frames: int
    error_frames: int
    busy_bits: int
    busy_share: float
    worst_1ms_bits: int
    worst_100ms_bits: int
    worst_100ms_share: float
    worst_delay_ns: dict[int, TimeNs]


@dataclass(frozen=True)
class LoadNow:
    """Frames and error frames of a segment so far, and the share (0..1) of the last stretch in
    which it was busy.
    """

    frames: int
    error_frames: int
    busy_share: float


class LoadMeter:
    """Adds up what a segment carries.

    passed: frames that got through and are not added up yet, in their order: (start of the frame,
    end of the intermission, bits until there, identifier, is_extended_id, delay since the request).
    The segment appends to it and calls `settle` for a block of them; it stays the same list.
    """

    def __init__(self, bitrate: int) -> None:
        self._bitrate = bitrate
        self.passed: list[tuple[TimeNs, TimeNs, int, int, bool, TimeNs]] = []
        self._busy_ns = array("Q")
        self._bits = 0
        self._frames = 0
        self._error_frames = 0
        self._worst_delay_ns: dict[int, TimeNs] = {}

    def settle(self) -> None:
        """Add up the frames in `passed`."""
        if not self.passed:
            return
        self._extend(self.passed[-1][1])
        if native_records is None:
            self._bits += self._add()
        else:
            windows, worst_ns = self._busy_ns, self._worst_delay_ns
            self._bits += native_records.add_load(self.passed, windows, worst_ns, WINDOW_NS)
        self._frames += len(self.passed)
        self.passed.clear()

    def _add(self) -> int:
        """Add the frames in `passed` to windows and delays; return their bits."""
        windows, worst_ns, bits_sum = self._busy_ns, self._worst_delay_ns, 0
        window = border_ns = 0
        for start_ns, end_ns, bits, can_id, extended, delay_ns in self.passed:
            bits_sum += bits
            if start_ns >= border_ns:
                window = start_ns // WINDOW_NS
                border_ns = (window + 1) * WINDOW_NS
            if end_ns <= border_ns:
                windows[window] += end_ns - start_ns
            else:
                self._spread(start_ns, end_ns)
            key = can_id | EXTENDED_FLAG if extended else can_id
            if delay_ns >= worst_ns.get(key, 0):
                worst_ns[key] = delay_ns
        return bits_sum

    def occupy(self, start_ns: TimeNs, end_ns: TimeNs, bits: int) -> None:
        """Add one occupation of the bus, a frame or an error frame with what it cut short."""
        self._bits += bits
        self._extend(end_ns)
        self._spread(start_ns, end_ns)

    def _extend(self, end_ns: TimeNs) -> None:
        """Make room for the windows until `end_ns`."""
        missing = (end_ns - 1) // WINDOW_NS + 1 - len(self._busy_ns)
        if missing > 0:
            self._busy_ns.extend([0] * missing)

    def _spread(self, start_ns: TimeNs, end_ns: TimeNs) -> None:
        """Add an occupation to the windows that it touches."""
        windows = self._busy_ns
        window, last = start_ns // WINDOW_NS, (end_ns - 1) // WINDOW_NS
        while window < last:
            border_ns = (window + 1) * WINDOW_NS
            windows[window] += border_ns - start_ns
            start_ns, window = border_ns, window + 1
        windows[window] += end_ns - start_ns

    def count_frame(self, can_id: int, extended: bool, delay_ns: TimeNs) -> None:
        """Note a frame that got through `delay_ns` after its request."""
        self._frames += 1
        key = can_id | EXTENDED_FLAG if extended else can_id
        if delay_ns >= self._worst_delay_ns.get(key, 0):
            self._worst_delay_ns[key] = delay_ns

    def count_error(self) -> None:
        """Note an error frame."""
        self._error_frames += 1

    def busy_bits(self, window_ns: TimeNs) -> list[int]:
        """Busy bits of each window since 0, to the nearest bit; the last one may be unfinished.

        Raises ValueError when `window_ns` is not a multiple of 1 ms.
        """
        if window_ns < WINDOW_NS or window_ns % WINDOW_NS:
            raise ValueError(f"window of {window_ns} ns is not a multiple of {WINDOW_NS} ns")
        self.settle()
        return [self._bits_of(busy_ns) for busy_ns in self._sums_ns(window_ns // WINDOW_NS)]

    def now(self, until_ns: TimeNs, span_ns: TimeNs) -> LoadNow:
        """Return what was carried until now; load of the whole windows in `span_ns` before."""
        self.settle()
        end = until_ns // WINDOW_NS
        begin = max(end - span_ns // WINDOW_NS, 0)
        busy_ns = sum(self._busy_ns[begin:end])
        whole_ns = (end - begin) * WINDOW_NS
        share = busy_ns / whole_ns if whole_ns else 0.0
        return LoadNow(self._frames, self._error_frames, share)

    def _sums_ns(self, step: int) -> Iterable[int]:
        """Return the busy time of every `step` windows."""
        windows = self._busy_ns
        if step == 1:
            return windows
        return (sum(windows[i : i + step]) for i in range(0, len(windows), step))

    def _bits_of(self, busy_ns: TimeNs) -> int:
        return (busy_ns * self._bitrate + S // 2) // S

    def _worst_ns(self, span_ns: TimeNs) -> TimeNs:
        """Return the most busy time in any stretch of so many windows in a row."""
        step = span_ns // WINDOW_NS
        windows = self._busy_ns
        inside = worst = sum(windows[:step])
        for leaves, enters in zip(windows, windows[step:], strict=False):
            inside += enters - leaves
            worst = max(worst, inside)
        return worst

    def figures(
        self, until_ns: TimeNs, waiting: Iterable[tuple[Frame, TimeNs]] = ()
    ) -> LoadFigures:
        """Sum up to `until_ns`, which must not be before the last end of a frame by a window.

        waiting: (frame, time of its request) of what has not been sent.
        """
        self.settle()
        busy_ns = sum(self._busy_ns)
        worst_ns = self._worst_ns(100 * MS)
        delays = dict(self._worst_delay_ns)
        for frame, requested_ns in waiting:
            key = frame.arbitration_id | (EXTENDED_FLAG if frame.is_extended_id else 0)
            delays[key] = max(delays.get(key, 0), until_ns - requested_ns)
        return LoadFigures(
            until_ns=until_ns,
            frames=self._frames,
            error_frames=self._error_frames,
            busy_bits=self._bits,
            busy_share=busy_ns / until_ns if until_ns else 0.0,
            worst_1ms_bits=self._bits_of(max(self._sums_ns(1), default=0)),
            worst_100ms_bits=self._bits_of(worst_ns),
            worst_100ms_share=worst_ns / min(until_ns, 100 * MS) if until_ns else 0.0,
            worst_delay_ns=dict(sorted(delays.items())),
        )
