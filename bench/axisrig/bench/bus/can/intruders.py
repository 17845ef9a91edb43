"""Nodes that should not be there: one that babbles, one that uses the identifier of another."""

import random
from collections.abc import Callable
from functools import partial

from axisrig.bench.bus.can.segment import Segment
from axisrig.bench.bus.hits import Hits, Window
from axisrig.kernel.time.clock import Phase, TimeNs


class Babbler:
    """A defect node that sends one identifier every `period_ns` while its window is open.

    It has one transmit buffer: what has not been sent when the next period begins stays the one
    frame that waits.
    """

    def __init__(
        self, segment: Segment, cob_id: int, data: bytes, period_ns: TimeNs, window: Window
    ) -> None:
        self._port = segment.port("babbler")
        self._port.attach_data(lambda _id, _data, _time: None)
        self._clock = segment.scheduler
        self._cob_id, self._data = cob_id, data
        self._period_ns, self._window = period_ns, window
        self._clock.call_at(self._clock.now_ns, Phase.APPLICATION, self._send)

    def _send(self) -> None:
        if self._window.is_open and not self._port.pending:
            self._port.send_raw(self._cob_id, self._data)
        self._clock.call_at(self._clock.now_ns + self._period_ns, Phase.APPLICATION, self._send)


class SecondSender:
    """A node that sends a telegram of another: after each frame of the real sender one of its own.

    content(last, random): what it sends; last: what the real sender sent one frame before.
    hits: which frames of the real sender are followed by one.
    """

    def __init__(
        self,
        segment: Segment,
        cob_id: int,
        content: Callable[[bytes, random.Random], bytes],
        after_ns: TimeNs,
        hits: Hits,
    ) -> None:
        self._port = segment.port("second sender")
        self._port.attach_data(self._on_frame)
        self._clock = segment.scheduler
        self._cob_id, self._content, self._after_ns = cob_id, content, after_ns
        self._hits = hits
        self._last: bytes | None = None

    def _on_frame(self, cob_id: int, data: bytes, _time: float) -> None:
        if cob_id != self._cob_id:
            return
        last, self._last = self._last, data
        if last is not None and self._hits.falls():
            send = partial(self._port.send_raw, cob_id, self._content(last, self._hits.numbers))
            time_ns = self._clock.now_ns + self._after_ns
            self._clock.call_at(time_ns, Phase.APPLICATION, send)
