"""What the distance controls were told: states, who commanded them, and with which parameters."""

from dataclasses import dataclass

from axisrig.kernel.channel import Channel
from axisrig.kernel.channel.distance.axis import source_word
from axisrig.kernel.distance import DistanceControl, DistanceSettings, DistanceState, Source
from axisrig.kernel.time.clock import TimeNs


@dataclass(frozen=True)
class Change:
    """What holds from a cycle on. time_ns: its SYNC. sensor: as `source_word` names it."""

    time_ns: TimeNs
    sensor: str
    state: DistanceState
    source: Source
    is_dry_run: bool
    settings: DistanceSettings

    def is_still(self, control: DistanceControl, sensor: str) -> bool:
        """Whether it holds for a control and its sensor."""
        return (
            self.state is control.state
            and self.sensor == sensor
            and self.is_dry_run == control.is_dry_run
            and self.source is control.source
            and self.settings is control.settings
        )


class DistanceLog:
    """Notes the controls of a channel, looked at in every NC cycle, when they change.

    A change of parameters while a control is not on is noted when it is switched on.
    """

    def __init__(self) -> None:
        self._changes: dict[str, list[Change]] = {}

    def __call__(self, channel: Channel) -> None:
        """Look at the controls of this cycle (step 7 of the cycle)."""
        for name, axis in channel.distance.axes.items():
            control, sensor = axis.control, source_word(axis.sensor)
            changes = self._changes.setdefault(name, [])
            if not changes or not changes[-1].is_still(control, sensor):
                changes.append(
                    Change(
                        channel.sync_ns,
                        sensor,
                        control.state,
                        control.source,
                        control.is_dry_run,
                        control.settings,
                    )
                )

    def of(self, axis: str) -> list[Change]:
        """Return the changes of an axis, in order: those of the parameters alone only while it is
        on.
        """
        kept: list[Change] = []
        for change in self._changes.get(axis, ()):
            if kept and kept[-1].state is change.state is DistanceState.INACTIVE:
                continue
            kept.append(change)
        return kept
