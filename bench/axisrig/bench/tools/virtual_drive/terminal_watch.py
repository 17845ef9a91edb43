"""Reports what a master outside sees of the stamping terminal of a line: states and stamps."""

from collections.abc import Callable, Mapping

from axisrig.bench.drive.ethercat.stamping import StampingTerminal
from axisrig.bench.machine.ethercat.line_meter import al_words
from axisrig.bench.rig.ethercat.members import TERMINAL
from axisrig.kernel.cosim.plant.plant import Plant
from axisrig.kernel.time.clock import TimeNs

Report = Callable[[TimeNs, str, str, str], None]


class TerminalWatcher:
    """Looks at a terminal. inputs: probes at its inputs, by their number from 1 on.

    report: takes instant, name, kind and text of what happens.
    """

    def __init__(
        self, terminal: StampingTerminal, inputs: Mapping[int, str], plant: Plant, report: Report
    ) -> None:
        self._terminal, self._inputs, self._plant, self._report = terminal, inputs, plant, report
        self._shown = self._state()
        self._edges: list[tuple[int, bool, TimeNs, int]] = []
        terminal.latches.stamped.append(self._note)

    def _note(self, number: int, level: bool, time_ns: TimeNs, stamp_ns: int) -> None:
        """Keep an edge for the next look: the frame that has shown it waits for its answer."""
        self._edges.append((number + 1, level, time_ns, stamp_ns))

    def look(self, time_ns: TimeNs) -> None:
        """Report what has changed since the last look."""
        shown = self._state()
        if shown != self._shown:
            self._report(time_ns, TERMINAL, "AL", f"{self._shown} -> {shown}")
            self._shown = shown
        for number, level, edge_ns, stamp_ns in self._edges:
            way = "up" if level else "down"
            text = f"input {number} {way}, stamp {stamp_ns} ns{self._contact(number, edge_ns)}"
            self._report(edge_ns, TERMINAL, "stamp", text)
        self._edges.clear()

    def _state(self) -> str:
        states = self._terminal.states
        return al_words(states.state, states.code)

    def _contact(self, number: int, edge_ns: TimeNs) -> str:
        """Say where the last contact before an edge was, of the probe at this input."""
        probe = self._plant.probes.get(self._inputs.get(number, ""))
        contacts = [] if probe is None else [c for c in probe.contacts if c.time_ns <= edge_ns]
        if not contacts:
            return ""
        last = max(contacts, key=lambda contact: contact.time_ns)
        places = [f"{plant} at {mm:.6f} mm" for plant, mm in last.position_mm.items()]
        return f"; contact was {', '.join(places)}"
