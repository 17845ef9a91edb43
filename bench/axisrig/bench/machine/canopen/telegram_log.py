"""Cyclic values as they went over the bus: what the wire says of dead time, apart from kernel and
drives.
"""

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
import pyarrow as pa

from axisrig.bench.bus.journal import Entry, Journal
from axisrig.bench.machine.recording.cyclic_values import (
    FIELDS,
    CyclicValues,
    FieldValues,
    lists_of,
    offsets_of,
)
from axisrig.bench.oracles.sources.telegrams import Telegram, counting
from axisrig.bench.record.series import FRAME_NS, INPUTS, Times
from axisrig.bench.rig.canopen.io_node import NodeTelegrams
from axisrig.kernel.drives.canopen.link import AxisLink


class TelegramLog(CyclicValues):
    """Notes 607A, 6064 and 60E4:1 of some axes, from the journal of their segments.

    links: of these axes, each with the name of its segment. terminal: the telegrams of the node
    with digital inputs that is the terminal of the PLC; it notes the ends of those that count.
    """

    def __init__(
        self,
        links: Iterable[tuple[str, AxisLink]],
        journal: Journal,
        terminal: NodeTelegrams | None = None,
    ) -> None:
        super().__init__()
        self._wanted: dict[tuple[str, int], tuple[Any, list[tuple[int, FieldValues]]]] = {}
        for segment, link in links:
            for telegram in link.telegrams.values():
                places = [
                    (place, self.of(link.name, mapped.field))
                    for place, mapped in enumerate(telegram.objects)
                    if mapped.field in FIELDS
                ]
                if places:
                    key = segment, telegram.cob_id(link.node_id)
                    self._wanted[key] = telegram.codec, places
        self._journal, self._terminal = journal, terminal
        self._of_terminal = None if terminal is None else (terminal.segment, terminal.cob_id)
        self._heard: list[Telegram] = []
        if self._wanted or terminal is not None:
            journal.add(self._take)

    def _take(self, block: Sequence[Entry]) -> None:
        """Note the values of a block of frames."""
        for time_ns, segment, frame, is_error in block:
            if (segment, frame.arbitration_id) == self._of_terminal:
                if not is_error and len(frame.data) == 1:
                    self._heard.append((time_ns, bytes(frame.data)))
                continue
            found = self._wanted.get((segment, frame.arbitration_id))
            if found is None or is_error or len(frame.data) != found[0].size:
                continue
            codec, places = found
            numbers = codec.unpack(frame.data)
            for place, values in places:
                values.frame_ns.append(time_ns)
                values.increments.append(numbers[place])

    def take_columns(self, times_ns: Times, *, is_last: bool) -> dict[str, pa.Array]:
        """Return lists of the values up to each instant that no earlier call has returned.

        times_ns: of the rows, shape (n,). is_last: what came after them belongs to the last row.
        """
        self._journal.drain()
        columns = super().take_columns(times_ns, is_last=is_last)
        node = self._terminal
        if node is not None:
            found = counting(self._heard, node.period_ns, node.first_ns, node.last_ns)
            ends = np.array([end_ns for end_ns, _ in found], dtype=np.int64)
            offsets = offsets_of(ends, times_ns, is_last=is_last)
            columns[f"{INPUTS}_{FRAME_NS}"] = lists_of(offsets, ends)
            until_ns = int(times_ns[-1]) if len(times_ns) and not is_last else 0
            self._heard = [each for each in self._heard if not is_last and each[0] > until_ns]
        return columns
