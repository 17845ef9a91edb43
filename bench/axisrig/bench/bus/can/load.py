"""Load of one segment: how long it was busy per window, and how long frames waited.

Busy counts from SOF to the end of the intermission, so 100 % is a bus on which nothing more fits.
"""

from array import array
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Final

import numpy as np

from axisrig.bench.bus.can.frame import Frame
from axisrig.bench.bus.can.native import native_records
from axisrig.kernel.time.clock import MS, S, TimeNs

WINDOW_NS: Final = MS
"""Resolution of the record; longer windows are sums of these."""

SPAN_WINDOWS: Final = 100
"""Windows in a row of which the worst are looked for."""

KEPT_WINDOWS: Final = 2048
"""Windows that are kept one by one, so that a long run needs no more memory than a short one."""

EXTENDED_FLAG: Final = 0x8000_0000
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
        self._busy_ns = array("Q")  # of the windows from `_begin_ns` on
        self._begin_ns: TimeNs = 0
        # Of the windows before
        self._past_ns = self._past_worst_ns = self._past_worst_100ms_ns = 0
        self._bits = 0
        self._frames = 0
        self._error_frames = 0
        self._worst_delay_ns: dict[int, TimeNs] = {}

    def settle(self) -> None:
        """Add up the frames in `passed`."""
        if not self.passed:
            return
        last_ns = self.passed[-1][1]
        self._extend(last_ns)
        if native_records is None:
            self._bits += self._add()
        else:
            self._bits += native_records.add_load(
                self.passed, self._busy_ns, self._worst_delay_ns, WINDOW_NS, self._begin_ns
            )
        self._frames += len(self.passed)
        self.passed.clear()
        if len(self._busy_ns) > KEPT_WINDOWS:
            self._fold(last_ns)

    def _fold(self, last_ns: TimeNs) -> None:
        """Sum up the windows that no frame can reach any more; last_ns: end of the last one."""
        count = (last_ns - self._begin_ns) // WINDOW_NS - SPAN_WINDOWS
        if count > 0:
            windows = self._busy_ns
            # What begins among them may end among those that stay
            seen = windows[: count + SPAN_WINDOWS]
            self._past_worst_100ms_ns = max(self._past_worst_100ms_ns, _worst_ns(seen))
            most_ns = max(seen)
            self._past_worst_ns = max(self._past_worst_ns, most_ns)
            self._past_ns += sum(windows[:count])
            del windows[:count]
            self._begin_ns += count * WINDOW_NS

    def _add(self) -> int:
        """Add the frames in `passed` to windows and delays; return their bits."""
        windows, worst_ns, bits_sum = self._busy_ns, self._worst_delay_ns, 0
        begin_ns, window, border_ns = self._begin_ns, 0, 0
        for start_ns, end_ns, bits, can_id, extended, delay_ns in self.passed:
            bits_sum += bits
            if start_ns >= border_ns:
                window = (start_ns - begin_ns) // WINDOW_NS
                border_ns = begin_ns + (window + 1) * WINDOW_NS
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
        missing = (end_ns - 1 - self._begin_ns) // WINDOW_NS + 1 - len(self._busy_ns)
        if missing > 0:
            self._busy_ns.extend([0] * missing)

    def _spread(self, start_ns: TimeNs, end_ns: TimeNs) -> None:
        """Add an occupation to the windows that it touches."""
        windows, begin_ns = self._busy_ns, self._begin_ns
        window, last = (start_ns - begin_ns) // WINDOW_NS, (end_ns - 1 - begin_ns) // WINDOW_NS
        while window < last:
            border_ns = begin_ns + (window + 1) * WINDOW_NS
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

        Raises ValueError when `window_ns` is not a multiple of 1 ms, or the first windows are not
        kept any more (KEPT_WINDOWS).
        """
        if window_ns < WINDOW_NS or window_ns % WINDOW_NS:
            raise ValueError(f"window of {window_ns} ns is not a multiple of {WINDOW_NS} ns")
        self.settle()
        if self._begin_ns:
            raise ValueError(f"windows before {self._begin_ns} ns are summed up")
        windows, step = self._busy_ns, window_ns // WINDOW_NS
        sums = (sum(windows[i : i + step]) for i in range(0, len(windows), step))
        return [self._bits_of(busy_ns) for busy_ns in sums]

    def now(self, until_ns: TimeNs, span_ns: TimeNs) -> LoadNow:
        """Return what was carried until now; load of the whole windows in `span_ns` before.

        Of these as many as are kept (KEPT_WINDOWS).
        """
        self.settle()
        end = until_ns // WINDOW_NS - self._begin_ns // WINDOW_NS
        begin = max(end - span_ns // WINDOW_NS, 0)
        busy_ns = sum(self._busy_ns[begin:end])
        whole_ns = (end - begin) * WINDOW_NS
        share = busy_ns / whole_ns if whole_ns else 0.0
        return LoadNow(self._frames, self._error_frames, share)

    def _bits_of(self, busy_ns: TimeNs) -> int:
        return (busy_ns * self._bitrate + S // 2) // S

    def figures(
        self, until_ns: TimeNs, waiting: Iterable[tuple[Frame, TimeNs]] = ()
    ) -> LoadFigures:
        """Sum up to `until_ns`, which must not be before the last end of a frame by a window.

        waiting: (frame, time of its request) of what has not been sent.
        """
        self.settle()
        busy_ns = self._past_ns + sum(self._busy_ns)
        worst_ns = max(self._past_worst_100ms_ns, _worst_ns(self._busy_ns))
        worst_1ms_ns = max(self._past_worst_ns, max(self._busy_ns, default=0))
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
            worst_1ms_bits=self._bits_of(worst_1ms_ns),
            worst_100ms_bits=self._bits_of(worst_ns),
            worst_100ms_share=worst_ns / min(until_ns, 100 * MS) if until_ns else 0.0,
            worst_delay_ns=dict(sorted(delays.items())),
        )


def _worst_ns(busy_ns: "array[int]") -> int:
    """Return the most busy time in 100 windows in a row, or in all where they are fewer."""
    if len(busy_ns) <= SPAN_WINDOWS:
        return sum(busy_ns)
    sums = np.cumsum(np.frombuffer(busy_ns, np.uint64), dtype=np.int64)
    inside = sums[SPAN_WINDOWS:] - sums[:-SPAN_WINDOWS]
    return max(int(sums[SPAN_WINDOWS - 1]), int(inside.max()))
