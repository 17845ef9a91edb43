"""What the control units of the PLC side do to the path and to axes that move beside it.

Sources: HLI, MC_Control units of a channel and of an axis (feedhold, override).
"""

from axisrig.kernel.channel.path.path import Path
from axisrig.kernel.channel.path.settings import OverrideMode
from axisrig.kernel.motion.feed import FULL
from axisrig.kernel.plc.interface import PlcInterface


class ControlUnits:
    """Carries out feedhold and override of channel and axes, and shows the tool."""

    def __init__(self, plc: PlcInterface, path: Path) -> None:
        self._plc, self._path = plc, path

    def step(self) -> None:
        """Give the PLC side its turn; raises the alarm that it has reported."""
        plc = self._plc
        if self._path.transformation.kinematic is not None or plc.tool.tilt_deg is not None:
            plc.show_tool(*self._path.transformation.state())
        for take in plc.inputs:
            take()
        plc.take_turn()
        override = plc.override_permille
        if override:
            self._path.override(override, self._slowed_axes())
        self._path.feedhold(is_on=plc.feedhold or not override, axes=self._held_axes())
        if plc.reported:
            raise plc.reported.pop(0)

    def _held_axes(self) -> list[str]:
        """Return the axes that their own feedhold or an override of 0 holds."""
        return [
            name
            for name, unit in self._plc.axis.items()
            if unit.feedhold or not unit.override_permille  # each cycle: without `holds`
        ]

    def _slowed_axes(self) -> dict[str, int]:
        """Return the overrides of axes between 0 and 100 %."""
        return {
            name: unit.override_permille
            for name, unit in self._plc.axis.items()
            if 0 < unit.override_permille < FULL
        }

    def override_beside_permille(self, axis: str) -> int:
        """Return the override of an axis that moves beside the path, 0 for one that is held."""
        unit = self._plc.axis[axis]
        if unit.feedhold:
            return 0
        of_channel = min(self._plc.override_permille, self._path.override_max_permille)
        match self._path.settings(axis).override_mode:
            case OverrideMode.CHANNEL:
                return of_channel
            case OverrideMode.LEAST:
                return min(of_channel, unit.override_permille)
            case OverrideMode.AXIS:
                return unit.override_permille
