"""History of the distance controls: states, who commanded them, and with which parameters."""

from dataclasses import dataclass

from axisrig.bench.oracles.distance.lists import CHANNEL
from axisrig.bench.record.distance import (
    Controller,
    Diagnosis,
    DistanceChange,
    DistanceOrder,
)
from axisrig.bench.record.kinematics import GuideChange
from axisrig.kernel.channel import Channel
from axisrig.kernel.channel.distance.guide import Guide, StayingGuide, ToolGuide
from axisrig.kernel.channel.distance.orders import Order
from axisrig.kernel.channel.distance.sensing import Sensing, source_word
from axisrig.kernel.distance import (
    DistanceControl,
    DistanceSettings,
    DistanceState,
    Source,
)
from axisrig.kernel.distance.objects import objects
from axisrig.kernel.distance.settings import field_name
from axisrig.kernel.parameters.units import UNITS_PER_MM
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

    A change of parameters while a control is not on is noted when it is switched on. What was asked
    of them is noted whenever it was.
    """

    def __init__(self) -> None:
        self._orders: list[tuple[TimeNs, Order]] = []
        self._changes: dict[str, list[Change]] = {}
        self._dumps: list[Diagnosis] = []
        self._guide: Guide | None = None
        self._guides: list[GuideChange] = []

    def __call__(self, channel: Channel) -> None:
        """Look at the controls of this cycle (step 7 of the cycle)."""
        new = channel.distance.orders[len(self._orders) :]
        self._orders += [(channel.sync_ns, order) for order in new]
        for name, axis in channel.distance.axes.items():
            self._look(channel, name, axis)
        found = channel.distance.channel
        if found is None:
            return
        self._note_guide(found.guide, channel.sync_ns)
        if self._look(channel, CHANNEL, found):
            self._dumps.append(Diagnosis(channel.sync_ns, dict(channel.distance.diagnosis())))

    def _look(self, channel: Channel, name: str, found: Sensing) -> bool:
        """Note a control when it has changed; return whether it has."""
        control, sensor = found.control, source_word(found.sensor)
        changes = self._changes.setdefault(name, [])
        if changes and changes[-1].is_still(control, sensor):
            return False
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
        return True

    def _note_guide(self, guide: Guide | None, time_ns: TimeNs) -> None:
        if guide is self._guide or isinstance(guide, StayingGuide):
            return  # where an offset stays follows from where it was, and when the kinematic went
        self._guide = guide
        if guide is None:
            found = GuideChange(time_ns)
        elif isinstance(guide, ToolGuide):
            found = GuideChange(time_ns, guide.mode, "", guide.normal, guide.origin_mm)
        else:
            found = GuideChange(time_ns, guide.mode, guide.axes[0])
        self._guides.append(found)

    @property
    def guides(self) -> tuple[GuideChange, ...]:
        """Where the offset of 3D control acted."""
        return tuple(self._guides)

    def dumps(self, channel: Channel) -> tuple[Diagnosis, ...]:
        """Return the diagnosis data of 3D control at every change, and as they are now."""
        if channel.distance.channel is None:
            return ()
        last = Diagnosis(channel.sync_ns, dict(channel.distance.diagnosis()))
        return (*self._dumps, last)

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

    @property
    def axes(self) -> list[str]:
        """Axes with a control, in the order of the channel."""
        return [name for name in self._changes if name != CHANNEL]

    def recorded(self, axis: str) -> tuple[DistanceChange, ...]:
        """Return the changes of an axis as the recording has them."""
        return tuple(_change(change) for change in self.of(axis))

    def orders(self, axis: str) -> tuple[DistanceOrder, ...]:
        """Return what was asked of an axis, or of CHANNEL, as the recording has it."""
        of_channel = axis == CHANNEL
        found = [
            (time_ns, order)
            for time_ns, order in self._orders
            if (order.axis is None if of_channel else order.axis == axis)
        ]
        by_program = {time_ns for time_ns, order in found if order.by == Source.NC.name}
        return tuple(
            _order(time_ns, order)
            for time_ns, order in found
            if order.action or order.parameters or time_ns in by_program
        )


def _order(time_ns: TimeNs, order: Order) -> DistanceOrder:
    words = {_listed_word(name): value for name, value in order.parameters.items()}
    values = order.is_dry_run, order.set_pos_mm, order.set_dist_mm
    return DistanceOrder(time_ns, order.by, order.action, *values, words)


def _listed_word(name: str) -> str:
    """Return how the lists call a parameter that the program has given."""
    known = {item.setting: item.parameter for item in objects().values() if item.is_writable}
    known["both_encoders"] = "mode_dist_use_both_encoder"
    return known.get(field_name(name), name)


def _change(change: Change) -> DistanceChange:
    return DistanceChange(
        change.time_ns,
        change.state.name,
        change.source.name,
        change.sensor,
        change.is_dry_run,
        controller(change.settings),
    )


def controller(settings: DistanceSettings) -> Controller:
    """Return the parameters of a control as the recording has them."""
    smooth = settings.filter
    return Controller(
        kp=settings.kp,
        tn_s=settings.tn_s,
        tv_s=settings.tv_s,
        filter_type=smooth.kind,
        count=smooth.n_cycles,
        alpha=smooth.smoothing_factor,
        order=smooth.low_pass_filter_order,
        corner_hz=smooth.low_pass_filter_fg_f0,
        sigma_mm=smooth.kalman_sigma / UNITS_PER_MM,
        both_encoders=settings.both_encoders,
        derivative_of=settings.law.derivative_of,
        limiter=settings.law.limiter,
        derivative=settings.law.derivative,
    )
