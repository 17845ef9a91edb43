"""The measurement run of the channel: begins it, leads its path, keeps its results.

A run is a `MeasuringRun` (a probe signals) or a `FixedStopRun` (rest at a stop is the signal).
"""

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from math import isinf
from typing import Final

from axisrig.kernel.channel.distance.offsets import Offsets
from axisrig.kernel.channel.path.dead_times import BehindMm, RunUp, dead_times, shares_of
from axisrig.kernel.channel.path.path import Path
from axisrig.kernel.channel.path.settings import AxisSettings, ChannelSettings, CycleTiming
from axisrig.kernel.channel.path.settling import Rest, Standstill
from axisrig.kernel.channel.path.simulated_probes import SimulatedProbes
from axisrig.kernel.channel.path.slaves import PathWithSlaves
from axisrig.kernel.channel.path.stop_way import StopWay, sent_to, straight_way
from axisrig.kernel.channel.probing.choice import ProbeChoice
from axisrig.kernel.channel.probing.ports import PlcPorts
from axisrig.kernel.drives.interface import Drive
from axisrig.kernel.errors import Alarm
from axisrig.kernel.measuring.fixed_stop_run import FixedStopRun, StopMotion, StopPlan, Watched
from axisrig.kernel.measuring.rules import least_stroke_mm, misses_signal
from axisrig.kernel.measuring.run import LatchPort, MeasuringRun, Order, RunRecord, RunState
from axisrig.kernel.motion.dynamics import Dynamics, Motion
from axisrig.kernel.nc import canon
from axisrig.kernel.nc.block import Block
from axisrig.kernel.nc.measuring_types import measuring_types
from axisrig.kernel.plc.interface import PlcInterface
from axisrig.kernel.time.clock import Clock

S_PER_MIN: Final = 60.0


@dataclass(frozen=True)
class _Order:
    """What a run does once its probes are armed."""

    target_mm: Mapping[str, float]
    speed_mm_s: float
    dynamics: Dynamics
    overtravel_mm: Mapping[str, float]
    run_up: RunUp


class Measurement:
    """Runs one measurement on the path at a time.

    links: by axis. slaves_of: gives the axes that follow others at the moment, each with its
    master. offsets: of distance control, which refuses a run while it is on. warn: takes alarms of
    class 1. plc: gives the signals of axes whose source is there. records: every run of the
    program, in order. prepared: axes that #MEAS PREPARE has named; a probe that the PLC switches
    is made ready, with other signals it stays a note.
    """

    def __init__(  # noqa: PLR0913
        self,
        clock: Clock,
        path: Path,
        links: Mapping[str, Drive],
        *,
        timing: CycleTiming,
        settings: ChannelSettings,
        slaves_of: Callable[[Collection[str]], Mapping[str, str]],
        offsets: Offsets,
        warn: Callable[[Alarm], None],
        plc: PlcInterface,
    ) -> None:
        self._clock, self._path, self._links, self._timing = clock, path, links, timing
        self._period_ns, self._settings, self._warn = timing.period_ns, settings, warn
        self._slaves_of, self._offsets = slaves_of, offsets
        self._run: MeasuringRun | FixedStopRun | None = None
        self._order: _Order | None = None
        self._simulated = SimulatedProbes(path, links, warn)
        self._standstill: Standstill | None = None
        self._measured: dict[str, float | None] = {}
        self.records: list[RunRecord] = []
        self.prepared: set[str] = set()
        self._choice = ProbeChoice(links, lambda axis: path.settings(axis).measuring)
        self._at_plc = PlcPorts(links, plc, clock)

    @property
    def is_active(self) -> bool:
        """Whether a run is under way."""
        return self._run is not None

    def state_of(self, axis: str) -> str | None:
        """Return the state of the run on the path in which an axis takes part, None without one."""
        if self._run is None or self._order is None:
            return None
        takes_part = axis in self._run.record.axes or axis in self._order.target_mm
        return self._run.state.name if takes_part else None

    def measured_acs_mm(self, axis: str) -> float | None:
        """Return the measured position of the axis' last run, None without a valid one."""
        return self._measured.get(axis)

    def is_actuated(self, axis: str) -> bool | None:
        """Return whether the probe of an axis has the level of its edge; None: not known, as where
        the PLC measures and does not run.
        """
        port = self._at_plc.find(axis, self._choice.source(axis))
        if port is None and self._choice.needs_plc(axis):
            return None
        return self._links[axis].is_actuated if port is None else port.is_actuated

    # Settings (#MEAS)

    def may_choose(self) -> bool:
        """Return whether no probe is armed, also not by an axis beside the path."""
        links = self._links.values()
        return not (self._at_plc.is_ordered or any(link.is_probing for link in links))

    def choose(self, command: canon.ProbeSettings) -> None:
        """Measure with another signal, edge or input; raises Alarm 50637, 900223 and 900227."""
        self._check_released(command.axis, 50637)
        self._choice.choose(command)

    def prepare(self, command: canon.PrepareProbe) -> None:
        """Make the probes of axes ready for a run; raises Alarm 50059 and 900400."""
        for name in command.axes:
            self._check_released(name, 50059)
        self.prepared.update(command.axes)
        for name in command.axes:
            if self._choice.needs_plc(name):
                self._at_plc.prepare(name, self._choice.source(name), *self._choice.latch(name))

    def forget_prepared(self, axis: str) -> None:
        """Reset the preparation of all axes when this one is among them.

        To be called when it is homed or leaves the channel. Source: FCT-C4 section 7.2.
        """
        if axis in self.prepared:
            self.end_preparation()

    def end_preparation(self) -> None:
        """Reset the preparation of all axes: the program has ended, by an alarm too."""
        self._at_plc.forget(self._links)
        self.prepared.clear()

    def end_program(self) -> None:
        """Forget what the program has set. Source: FCT-C4 section 7.2, PROG 207092107."""
        self.end_preparation()
        self.choose_default()

    def begin_program(self) -> None:
        """Forget what a program before has measured."""
        self._measured.clear()

    def choose_default(self, _command: canon.DefaultProbes | None = None) -> None:
        """Measure with what the parameter lists say."""
        self._choice.choose_default()

    # The run

    def begin(self, command: canon.MeasuringRun) -> None:
        """Begin a run on the path.

        Raises Alarm 50059, 900100, 900103, 900224, 900241, 900242, 900400 and those of the run.
        """
        type_, measuring = command.measuring_type, command.measuring_axes
        for name in dict.fromkeys((*command.programmed_axes, *measuring)):
            self.check(name, type_)
        self._order = self._planned(command)
        if measuring_types()[type_].runs_to_stop:
            way = straight_way(self._path, self._links.values(), command.target_mm)
            slaves = self._with_settings(self._slaves_of(way.moved))
            motion = PathWithSlaves(self._path, slaves, self._clock, self._period_ns)
            self._run = self.arm_stop(measuring, way, command.block, motion)
            return
        self._run = self.arm(
            type_,
            measuring,
            command.block,
            error_no_signal=command.error_no_signal,
            goes_on=command.goes_on,
            simulated=self._simulated.make(command),
            behind_mm=self._order.run_up.behind_mm,
        )

    def arm(
        self,
        measuring_type: int,
        axes: Sequence[str],
        block: Block,
        *,
        error_no_signal: bool | None = None,
        goes_on: bool = False,
        simulated: Mapping[str, LatchPort] | None = None,
        behind_mm: BehindMm,
    ) -> MeasuringRun:
        """Make a run of released axes, and note it; who moves them has to evaluate it.

        error_no_signal: None = P-CHAN-00176. simulated: what gives the signal in place of the
        drive, by axis. behind_mm: see `dead_times`. Raises Alarm 50052.
        """
        kind = measuring_types()[measuring_type]
        choice = self._choice
        at_plc = {
            name: self._at_plc.choose(name, choice.source(name), *choice.latch(name))
            for name in axes
            if choice.needs_plc(name)
        }
        ports: dict[str, LatchPort] = {**self._links, **at_plc, **(simulated or {})}
        run = MeasuringRun(
            [ports[name] for name in axes],
            str(block),
            self._clock.now_ns,
            misses_signal(kind, self._settings.error_no_signal, error_no_signal),
            goes_on=goes_on,
            dead_times=dead_times(self._path, self._links, axes, self._period_ns, behind_mm),
            warn=lambda alarm: self._warn(alarm.at(block.place)),
        )
        run.record.inputs.update({name: choice.latch(name)[0] for name in axes})
        run.record.sources.update({name: choice.source(name) for name in axes})
        self._note(run.record)
        return run

    def _note(self, record: RunRecord) -> None:
        """Note a run that begins: what its axes have measured before is gone."""
        self.records.append(record)
        self._measured.update(dict.fromkeys(record.axes))

    def arm_stop(
        self, measuring: Sequence[str], way: StopWay, block: Block, motion: StopMotion
    ) -> FixedStopRun:
        """Make a run to a fixed stop, and note it; who moves the axes has to evaluate it.

        measuring: the axes that deliver a position. way: of the block, whose axes are those at
        which the stop is looked for; at slaves where their master wants it (P-AXIS-00835). Raises
        Alarm 51026.
        """
        links, settings = self._links, self._path.settings
        moved = [name for name in links if name in way.moved]
        slaves = self._slaves_of(moved)
        searched = [
            slave
            for slave, master in slaves.items()
            if settings(master).measuring.fixed_stop.watches_slaves
        ]
        axes = self._with_settings((*moved, *searched))
        plan = StopPlan(
            measuring=[links[name] for name in measuring],
            watched=[Watched(link, of.measuring.fixed_stop, of.window_mm) for of, link in axes],
            moved=[links[name] for name in moved],
            sent=way.sent or sent_to(links[name] for name in moved),
            block_mm=way.length_mm,
            is_error=not self._settings.stop_may_be_missing,
            rest=lambda: Rest(self._clock, self._period_ns, axes).judge,
            slaves=[links[name] for name in slaves],
        )
        run = FixedStopRun(plan, motion, str(block), self._clock.now_ns, self._period_ns)
        self._note(run.record)
        return run

    def _with_settings(self, names: Iterable[str]) -> list[tuple[AxisSettings, Drive]]:
        return [(self._path.settings(name), self._links[name]) for name in names]

    def keep(self, record: RunRecord) -> None:
        """Keep the results of a run."""
        self._measured.update({axis: record.latched_mm.get(axis) for axis in record.axes})

    def speed_mm_s(
        self,
        measuring_type: int,
        block: Block,
        named: Sequence[str],
        moving: Sequence[str],
        wanted_mm_s: float,
        dynamics: Dynamics,
    ) -> float:
        """Return the speed of a run: that of its axis (type 2), within the stroke of its probe.

        named: axes of the block. moving: those that the path moves. dynamics: of the path. Warns
        with 900222 when the stroke lowers it; raises Alarm 900224 for a probe without a stroke.
        """
        axes = {name: self._path.settings(name).measuring for name in moving}
        if measuring_types()[measuring_type].has_own_speed:
            wanted_mm_s = self._path.settings(named[0]).measuring.speed_mm_s
        programmed_mm_s, wanted_mm_s = wanted_mm_s, min(wanted_mm_s, dynamics.speed_max_mm_s)
        stroke_mm = self._stroke_mm(measuring_type, moving)
        if isinf(stroke_mm):
            return wanted_mm_s
        highest_mm_s = dynamics.stop_deceleration.speed_within(stroke_mm)
        if wanted_mm_s <= highest_mm_s:
            return wanted_mm_s
        least = min(axes, key=lambda name: axes[name].stroke_mm)
        if not highest_mm_s:
            raise Alarm(900224, axis=least, type=measuring_type)
        warning = Alarm(
            900222,
            place=block.place,
            axis=least,
            speed_mm_min=f"{programmed_mm_s * S_PER_MIN:.9g}",
            stroke_mm=f"{axes[least].stroke_mm:.9g}",
            corrected_mm_min=f"{highest_mm_s * S_PER_MIN:.9g}",
        )
        self._warn(warning)
        return highest_mm_s

    def _stroke_mm(self, measuring_type: int, moving: Iterable[str]) -> float:
        axes = [self._path.settings(name).measuring for name in moving]
        return least_stroke_mm(measuring_types()[measuring_type], axes)

    def within_stroke(
        self, measuring_type: int, moving: Iterable[str], dynamics: Dynamics
    ) -> Dynamics:
        """Return what a run may do at any override: no more than the stroke of its probe allows."""
        stroke_mm = self._stroke_mm(measuring_type, moving)
        return dynamics if isinf(stroke_mm) else dynamics.within_stroke(stroke_mm)

    def check(self, axis: str, measuring_type: int, *, is_beside: bool = False) -> None:
        """Raise Alarm 50059, 900100, 900241, 900242 or 900400 for an axis that cannot take part.

        is_beside: it moves beside the path. Raises Alarm 900521 while its distance control is on.
        """
        self._check_released(axis, 50059)
        self._offsets.check_measuring(axis)
        source = self._choice.source(axis)
        kind, measuring = measuring_types()[measuring_type], self._path.settings(axis).measuring
        measuring.check(axis, kind, source, is_beside=is_beside)
        if self._choice.needs_plc(axis):
            self._at_plc.task(axis, source)

    def _check_released(self, axis: str, alarm_id: int) -> None:
        if not self._path.settings(axis).may_measure:
            raise Alarm(alarm_id, axis=axis)

    def _planned(self, command: canon.MeasuringRun) -> _Order:
        target, type_ = command.target_mm, command.measuring_type
        kind = measuring_types()[type_]
        overtravel_mm = {
            name: self._path.settings(name).measuring.overtravel_mm(kind) for name in target
        }
        dynamics = self._path.dynamics(target, Motion.MEASURING, overtravel_mm=overtravel_mm)
        rapid = self._path.dynamics(target, Motion.RAPID, overtravel_mm=overtravel_mm)
        if dynamics is None or rapid is None:
            raise Alarm(900103, axes=" ".join(command.programmed_axes))
        feed_mm_min = command.feed_mm_min
        wanted_mm_s = rapid.speed_max_mm_s if feed_mm_min is None else feed_mm_min / S_PER_MIN
        speed_mm_s = self.speed_mm_s(
            type_, command.block, command.programmed_axes, tuple(target), wanted_mm_s, dynamics
        )
        dynamics = self.within_stroke(type_, target, dynamics)
        run_up = RunUp(dynamics, shares_of(self._path, target), speed_mm_s)
        return _Order(target, speed_mm_s, dynamics, overtravel_mm, run_up)

    def step(self) -> None:
        """Evaluate the run with this cycle's values and lead the path by what it orders."""
        self._at_plc.look()
        if self._run is None:
            return
        assert self._order is not None
        ordered = self._order
        order = self._evaluate(self._run)
        if order is Order.START:
            self._standstill = self.standstill(self._run.record.axes)
            self._path.begin(
                ordered.target_mm,
                ordered.speed_mm_s,
                ordered.dynamics,
                overtravel_mm=ordered.overtravel_mm,
            )
        elif order is Order.BRAKE:
            self._path.brake()
        elif order is Order.RELAX:
            assert isinstance(self._run, FixedStopRun)
            self._relax(self._run.targets_mm, ordered.speed_mm_s)
        if self._run.is_done:
            self.keep(self._run.record)
            self._forget()

    def _forget(self) -> None:
        self._run = self._order = self._standstill = None

    def standstill(self, axes: Iterable[str]) -> Standstill:
        """Make the watch over measuring axes that are about to move."""
        return Standstill(self._clock, self._timing, self._with_settings(axes))

    def _evaluate(self, run: MeasuringRun | FixedStopRun) -> Order:
        now_ns = self._clock.now_ns
        if isinstance(run, FixedStopRun):
            return run.evaluate(now_ns)
        if run.state is RunState.MOVING:
            self._simulated.look()
        standstill = self._standstill
        rest_ns = None if standstill is None else standstill.look(self._path.has_stopped)
        return run.evaluate(now_ns, self._path.is_in_position(), rest_ns)

    def _relax(self, targets_mm: Mapping[str, float], speed_mm_s: float) -> None:
        """Lead the axes straight to where they are to rest, no faster than the run."""
        path = self._path
        targets_mm = {axis: mm - path.superposed_mm(axis) for axis, mm in targets_mm.items()}
        path.lead_back(targets_mm, speed_mm_s)

    def reset(self) -> None:
        """End every run without a result, and forget what the program has set."""
        self.abort()
        for record in self.records:
            if record.end_ns is None:
                record.end_ns = self._clock.now_ns
                record.latched_mm.clear()
        self.end_program()

    def abort(self) -> None:
        """End a run without a result: its probes are switched off."""
        if self._run is not None:
            self._run.abort()
        self._forget()
