"""Which signal, input and edge each axis measures with: #MEAS, else its list."""

from collections.abc import Callable, Mapping

from axisrig.kernel.drives.interface import Drive
from axisrig.kernel.errors import Alarm
from axisrig.kernel.measuring.rules import (
    EXTERNAL,
    EXTERNAL_WITH_DRIVE,
    OF_PLC,
    MeasuringAxis,
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
        most = self._measuring(axis).inputs_of(source)
        return (number if number <= most else link.probe_input), edge

    def needs_plc(self, axis: str) -> bool:
        """Return whether the signal of an axis, or its probe, is at the PLC."""
        return self._measuring(axis).needs_plc(self.source(axis))

    def choose(self, command: canon.ProbeSettings) -> None:
        """Measure with another signal, edge or input; raises Alarm 70390, 900223 and 900227."""
        axis, input_, edge = command.axis, command.probe_input, command.edge
        if command.source is not None:
            self._sources[axis] = command.source
        if command.probe is not None:
            input_ = self._measuring(axis).probe_inputs[command.probe]
        source, drive = self.source(axis), self._measuring(axis).drive
        most = self._measuring(axis).inputs_of(source)
        is_of_drive = source not in OF_PLC or source == EXTERNAL_WITH_DRIVE
        wrong = {
            "INPUT": (input_, f"1 .. {most}", input_ is not None and input_ > most),
            "EDGE": (edge, " ".join(drive.edges), bool(edge) and edge not in drive.edges),
        }
        for keyword, (value, allowed, is_wrong) in wrong.items():
            if is_wrong and (is_of_drive or keyword == "INPUT"):
                place = command.block.place
                raise Alarm(900227, place=place, keyword=keyword, value=value, allowed=allowed)
        known_input, known_edge = self.latch(axis)
        if is_of_drive and input_ not in (None, known_input) and not drive.may_change_input:
            raise Alarm(
                70390, axis=axis, drive_type=drive.name, source=source, wrong=input_,
                corrected=known_input,
            )  # fmt: skip
        self._latches[axis] = input_ or known_input, edge or known_edge
        if is_of_drive:
            self._links[axis].choose_latch(*self._latches[axis])

    def choose_default(self) -> None:
        """Measure with what the lists say."""
        self._sources.clear()
        self._latches.clear()
        for link in self._links.values():
            chosen = link.settings.probe_input, link.settings.edge
            if (link.probe_input, link.edge) != chosen:
                link.choose_latch(*chosen)
