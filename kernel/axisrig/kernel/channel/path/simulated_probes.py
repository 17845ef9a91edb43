"""The probes of a run on the path that the CNC simulates (P-AXIS-00112)."""

from collections.abc import Callable, Collection

from axisrig.kernel.channel.path.path import Path
from axisrig.kernel.errors import Alarm
from axisrig.kernel.measuring.simulated import ALL, Body, SimulatedProbe, Way
from axisrig.kernel.motion.tool_path import ToolCurve
from axisrig.kernel.nc import canon


class SimulatedProbes:
    """Makes them for a run and shows them where the path is; names: of all axes of the path."""

    def __init__(self, path: Path, names: Collection[str], warn: Callable[[Alarm], None]) -> None:
        self._path, self._names, self._warn = path, tuple(names), warn
        self._probes: tuple[SimulatedProbe, ...] = ()

    def make(self, command: canon.MeasuringRun) -> dict[str, SimulatedProbe]:
        """Make the probes of the axes of a run whose lists say that they are simulated.

        Warns with 900523 where SIMU_OFFSET shifts none of them.
        """
        path = self._path
        found: dict[str, SimulatedProbe] = {}
        lists = {name: path.settings(name).measuring.simulated for name in self._names}
        modes = {name: lists[name][0] for name in command.measuring_axes}
        offset_mm = command.simulated_offset_mm
        if offset_mm and ALL not in modes.values():
            self._warn(Alarm(900523, place=command.block.place, offset_mm=f"{offset_mm:g}"))
        if any(modes.values()):
            curve, here_mm = path.straight(command.target_mm), path.position_mm()
            places, share = [curve.start_mm, curve.end_mm], 1.0
            if isinstance(curve, ToolCurve):
                places, share = curve.places, curve.share
            along = dict(zip(here_mm, zip(*places, strict=True), strict=True))
            way = Way(here_mm, command.target_mm, offset_mm, command.programmed_axes, share)
            for name, mode in modes.items():
                if mode:
                    found[name] = SimulatedProbe(
                        name, mode, lists[name][1], way, along[name], Body.of(lists)
                    )
        self._probes = tuple(found.values())
        return found

    def look(self) -> None:
        """Take the set positions of one cycle of the motion."""
        if self._probes:
            axes_mm = {name: self._path.position_acs_mm(name) for name in self._names}
            here_mm = self._path.position_mm()
            for probe in self._probes:
                probe.look(axes_mm, here_mm)
