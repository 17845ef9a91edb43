"""Which signal, input and edge each axis measures with: #MEAS, else its list."""

from collections.abc import Callable, Mapping

from axisrig.kernel.drives.interface import Drive
from axisrig.kernel.errors import Alarm
from axisrig.kernel.measuring.rules import (
    EXTERNAL,
    EXTERNAL_WITH_DRIVE,
    OF_PLC,
    MeasuringAxis,
    inputs_of,
)
from axisrig.kernel.nc import canon


class ProbeChoice:
    """What #MEAS has chosen; measuring: gives what the list of an axis says."""

    def __init__(
        self, links: Mapping[str, Drive], measuring: Callable[[str], MeasuringAxis]
    ) -> None:
        self._links, self._measuring = links, measuring
        self._sources: dict[str, str] = {}
        self._latches: dict[str, tuple[int, str]] = {}

    def source(self, axis: str) -> str:
        """Return where the signal of an axis comes from: #MEAS, else P-AXIS-00516."""
        return self._sources.get(axis, self._measuring(axis).source)

    def latch(self, axis: str) -> tuple[int, str]:
        """Return input and edge of an axis: #MEAS, else P-AXIS-00517 and 00518.

        An input that was chosen for external hardware does not count for a drive.
        """
        link, source = self._links[axis], self.source(axis)
        of_list = self._measuring(axis).probe_input if source == EXTERNAL else link.probe_input
        number, edge = self._latches.get(axis, (of_list, link.edge))
        return (number if number <= inputs_of(source) else link.probe_input), edge

    def needs_plc(self, axis: str) -> bool:
        """Return whether the signal of an axis, or its probe, is at the PLC."""
        return self._measuring(axis).needs_plc(self.source(axis))

    def choose(self, command: canon.ProbeSettings) -> None:
        """Measure with another signal, edge or input; raises Alarm 900223 and 900227."""
        axis, input_ = command.axis, command.probe_input
        if command.source is not None:
            self._sources[axis] = command.source
        if command.probe is not None:
            input_ = self._measuring(axis).probe_inputs[command.probe]
        source = self.source(axis)
        most = inputs_of(source)
        if input_ is not None and input_ > most:
            place, allowed = command.block.place, f"1 .. {most}"
            raise Alarm(900227, place=place, keyword="INPUT", value=input_, allowed=allowed)
        known_input, known_edge = self.latch(axis)
        self._latches[axis] = input_ or known_input, command.edge or known_edge
        if source not in OF_PLC or source == EXTERNAL_WITH_DRIVE:
            self._links[axis].choose_latch(*self._latches[axis])

    def choose_default(self) -> None:
        """Measure with what the lists say."""
        self._sources.clear()
        self._latches.clear()
        for link in self._links.values():
            chosen = link.settings.probe_input, link.settings.edge
            if (link.probe_input, link.edge) != chosen:
                link.choose_latch(*chosen)
