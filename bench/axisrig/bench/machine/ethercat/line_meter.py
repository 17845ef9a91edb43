"""What the EtherCAT lines of a run have carried, counted where frames are back at the master."""

from array import array
from collections.abc import Iterable
from functools import partial

import numpy as np

from axisrig.bench.bus.ethercat.frame import time_on_wire_ns
from axisrig.bench.bus.journal import Entry, Journal
from axisrig.bench.machine.ethercat.line import Line
from axisrig.bench.record.bus import BusChange
from axisrig.kernel.drives.ethercat.frames import INDEX_PLACE
from axisrig.kernel.drives.ethercat.master import FIRST_INDEX
from axisrig.kernel.profiles.ethercat.tables import AlState, al_status_text, state_name
from axisrig.kernel.time.clock import Clock, TimeNs


class LineMeter:
    """One line. back, wrong, wrong_in_a_row: of cyclic frames, as `LineFigures` has them.

    changes: of the AL states of its slaves, from the first time that each was in OP.
    """

    def __init__(self, line: Line, clock: Clock) -> None:
        self._line, self._clock = line, clock
        self.back = self.wrong = self.wrong_in_a_row = 0
        self.changes: list[BusChange] = []
        self._in_a_row = 0
        self._has_been_right = False
        self._ends_ns, self._wires_ns = array("q"), array("q")
        self._states: dict[str, tuple[AlState, int]] = {}
        for axis, node in line.nodes.items():
            node.states.observers.append(partial(self._entered, axis))

    def _entered(self, axis: str, state: AlState, code: int) -> None:
        """Note the AL state of a slave once it has been in OP."""
        last, new = self._states.get(axis), (state, code)
        if (last is None and state is not AlState.OP) or last == new:
            return
        self._states[axis] = new
        if last is not None:
            words, is_active = al_words(state, code), state is AlState.OP
            self.changes.append(BusChange(self._clock.now_ns, axis, words, is_active))

    def take(self, time_ns: TimeNs, frame: bytes) -> None:
        """Note a frame that is back."""
        self._ends_ns.append(time_ns)
        self._wires_ns.append(time_on_wire_ns(len(frame)))
        if frame[INDEX_PLACE] < FIRST_INDEX:
            return
        self.back += 1
        if self._line.master.image_in(frame) is not None:
            self._has_been_right, self._in_a_row = True, 0
        elif self._has_been_right:
            self.wrong += 1
            self._in_a_row += 1
            self.wrong_in_a_row = max(self.wrong_in_a_row, self._in_a_row)

    def load_pct(self, until_ns: TimeNs) -> float:
        """Return the load from 0 on."""
        return 100.0 * sum(self._wires_ns) / until_ns if until_ns else 0.0

    def worst_pct(self, window_ns: TimeNs, until_ns: TimeNs) -> float:
        """Return the load of the window that has most; it ends with a frame."""
        if not self._ends_ns or not until_ns:
            return 0.0
        ends_ns = np.array(self._ends_ns, dtype=np.float64)
        wires_ns = np.array(self._wires_ns, dtype=np.float64)
        busy_ns = np.cumsum(wires_ns)
        # What was busy until each begin and end of a frame; in between it grows with time
        times_ns = np.stack([ends_ns - wires_ns, ends_ns], axis=1).ravel()
        until = np.stack([busy_ns - wires_ns, busy_ns], axis=1).ravel()
        before = np.interp(ends_ns - window_ns, times_ns, until, left=0.0)
        return 100.0 * float(np.max(busy_ns - before)) / min(window_ns, until_ns)

    def recent_pct(self, now_ns: TimeNs, span_ns: TimeNs) -> float:
        """Return the load of the last time, by the frames that ended in it."""
        busy_ns = 0
        for place in range(len(self._ends_ns) - 1, -1, -1):
            if self._ends_ns[place] <= now_ns - span_ns:
                break
            busy_ns += self._wires_ns[place]
        return 100.0 * busy_ns / span_ns


class LineMeters:
    """Those of all lines, by name; they read a journal."""

    def __init__(self, lines: Iterable[Line], clock: Clock, journal: Journal) -> None:
        self._of = {line.segment.name: LineMeter(line, clock) for line in lines}
        self._journal = journal
        journal.add(self._take)

    def _take(self, block: list[Entry]) -> None:
        for time_ns, segment, frame, _ in block:
            self._of[segment].take(time_ns, frame)

    def __getitem__(self, name: str) -> LineMeter:
        self._journal.drain()
        return self._of[name]


def al_words(state: AlState, code: int) -> str:
    """Say the state of a slave, and why it is there."""
    return state_name(state) + (f", {al_status_text(code)}" if code else "")
