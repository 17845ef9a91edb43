"""One measurement run to a fixed stop (type 7), evaluated once per NC cycle.

    STARTING   lag monitoring of the CNC off, then the path
    MOVING     the path is travelled; after the arming every watched axis is judged, and the first
               whose criteria hold ends the motion
    BRAKING    the distance to go is deleted; the actual positions of the detection are kept
    RELAXING   the set positions are led back to them, which takes the lag away
    DONE       the axes rest in their windows, lag monitoring is on again

The place of the stop is not known here: position lag and actual position show it. The axes come as
`StopPort`, the motion as `StopMotion`: the path of the channel, or an axis beside it.
Sources: FCT-C4 7.3, its sequence in 7.3.1.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from enum import Enum, auto
from math import dist
from typing import Final, Protocol

from axisrig.kernel.errors import Alarm
from axisrig.kernel.measuring.fixed_stop.detector import StopDetector
from axisrig.kernel.measuring.fixed_stop.record import Criteria, FixedStopRecord
from axisrig.kernel.measuring.fixed_stop.settings import FixedStopSettings
from axisrig.kernel.measuring.run import Order, RunRecord
from axisrig.kernel.time.clock import TimeNs

SAME_MM: Final = 1e-9
MS_PER_NS: Final = 1e-6


class StopPort(Protocol):
    """One axis as the run sees it; set_mm: what was sent last. Lengths in mm."""

    watches_lag: bool

    @property
    def name(self) -> str: ...  # noqa: D102
    @property
    def set_mm(self) -> float: ...  # noqa: D102
    @property
    def actual_mm(self) -> float: ...  # noqa: D102
    @property
    def lag_mm(self) -> float: ...  # noqa: D102


class StopMotion(Protocol):
    """The motion that the run orders.

    travelled_mm: path of the interpolation since the start of the block. has_stopped: the same set
    positions are sent again and again, and no way is left.
    """

    @property
    def travelled_mm(self) -> float: ...  # noqa: D102
    @property
    def has_stopped(self) -> bool: ...  # noqa: D102

    def is_in_position(self) -> bool: ...  # noqa: D102


@dataclass(frozen=True)
class Watched:
    """An axis at which the stop is looked for; exact_stop_mm: P-AXIS-00236."""

    port: StopPort
    settings: FixedStopSettings
    exact_stop_mm: float


@dataclass(frozen=True)
class StopPlan:
    """What a run is about.

    measuring: the axes that deliver a position. watched: where the stop is looked for. moved: the
    axes of the motion, which is led back at its end. sent: gives what was sent last, as a place on
    the path whose steps show whether it slows. block_mm: length of the programmed path.
    is_error: finding no stop is an alarm (P-CHAN-00266). rest: makes what reports, asked once per
    cycle, whether the watched axes have come to rest. slaves: they follow axes of the motion.
    """

    measuring: Sequence[StopPort]
    watched: Sequence[Watched]
    moved: Sequence[StopPort]
    sent: Callable[[], tuple[float, ...]]
    block_mm: float
    is_error: bool
    rest: Callable[[], Callable[[], bool]]
    slaves: Sequence[StopPort] = ()

    @property
    def involved(self) -> Sequence[StopPort]:
        """The axes whose lag is not monitored meanwhile."""
        return (*self.measuring, *self.slaves)


class _State(Enum):
    STARTING = auto()
    MOVING = auto()
    BRAKING = auto()
    RELAXING = auto()
    DONE = auto()


class FixedStopRun:
    """Evaluates one run; `targets_mm` says where to go when it orders Order.RELAX.

    Raises Alarm 51026 (P-AXIS-00777 or 00772 above 1000) and 900240 (no stop found).
    """

    def __init__(
        self, plan: StopPlan, motion: StopMotion, block: str, now_ns: TimeNs, period_ns: TimeNs
    ) -> None:
        for axis in plan.watched:
            axis.settings.check(axis.port.name)
        self._plan, self._motion = plan, motion
        self._state, self._now_ns = _State.STARTING, now_ns
        self._axes = [(w, StopDetector(w.settings.criteria(period_ns))) for w in plan.watched]
        self._set = _SetPath(plan.sent)
        self._rests: Callable[[], bool] | None = None
        self._rest_ns: TimeNs | None = None
        self._window_from_mm = 0.0
        self.targets_mm: dict[str, float] = {}
        self.stop = FixedStopRecord(
            {w.port.name: detector.criteria for w, detector in self._axes},
            min(w.settings.start_mm(plan.block_mm) for w in plan.watched),
            axes=tuple(port.name for port in plan.involved),
        )
        self.record = RunRecord(
            tuple(port.name for port in plan.measuring),
            block,
            begin_ns=now_ns,
            fixed_stop=self.stop,
        )
        self._steps: dict[_State, Callable[[TimeNs], Order]] = {
            _State.STARTING: self._starting,
            _State.MOVING: self._moving,
            _State.BRAKING: self._braking,
            _State.RELAXING: self._relaxing,
        }

    @property
    def state(self) -> Enum:
        """How far the run is."""
        return self._state

    @property
    def is_done(self) -> bool:
        """Whether the results are final."""
        return self._state is _State.DONE

    def evaluate(self, now_ns: TimeNs) -> Order:
        """Advance the run with this cycle's values."""
        self._now_ns = now_ns
        step = self._steps.get(self._state)
        return step(now_ns) if step else Order.NONE

    def abort(self) -> None:
        """End as it is, without a result when the axes are still on their way."""
        self._state = _State.DONE
        for port in self._plan.involved:
            port.watches_lag = True
        if self.stop.watch_off_ns is not None:
            self.stop.watch_on_ns = self._now_ns

    # The way to the stop

    def _starting(self, now_ns: TimeNs) -> Order:
        for port in self._plan.involved:
            port.watches_lag = False
        self.stop.watch_off_ns = self.record.start_ns = now_ns
        self._take(now_ns)
        self._state = _State.MOVING
        return Order.START

    def _take(self, now_ns: TimeNs) -> None:
        is_armed = self.stop.armed_ns is not None
        for axis, detector in self._axes:
            port = axis.port
            detector.take(now_ns, port.lag_mm, port.actual_mm, is_armed=is_armed)

    def _moving(self, now_ns: TimeNs) -> Order:
        if self.stop.armed_ns is None and self._reaches(self.stop.start_distance_mm):
            self.stop.armed_ns = now_ns
        self._take(now_ns)
        self._set.look()
        if self._set.has_moved and (self._set.rests or self._set.slows):
            self._window_from_mm = self._motion.travelled_mm + self.stop.start_distance_mm
        is_at_rest = self._is_at_rest(now_ns)
        for axis, detector in self._axes:
            if detector.is_fulfilled(window_decides=self._window_decides(axis, is_at_rest)):
                return self._find(axis.port.name, now_ns)
        if is_at_rest and self._motion.has_stopped and not self._may_still_come(now_ns):
            return self._miss(now_ns)
        return Order.NONE

    def _reaches(self, distance_mm: float) -> bool:
        return self._motion.travelled_mm >= distance_mm - SAME_MM

    def _is_at_rest(self, now_ns: TimeNs) -> bool:
        """Whether the watched axes rest while the set positions rest."""
        if not self._set.rests:
            self._rests = self._rest_ns = None
            return False
        if self._rests is None:
            self._rests = self._plan.rest()
        if not self._rests():
            return False
        if self._rest_ns is None:
            self._rest_ns = now_ns
        return True

    def _window_decides(self, axis: Watched, is_at_rest: bool) -> bool:
        """Whether a window that holds shows a stop, alone or beside the lag.

        Not while the set positions brake or rest, at the target or in a feedhold: an axis that
        follows them is no axis at a stop. When they rest an axis that rests outside its window is.
        """
        if self._set.rests:
            return is_at_rest and _is_held_off(axis)
        return not self._set.slows and self._reaches(self._window_from_mm)

    def _may_still_come(self, now_ns: TimeNs) -> bool:
        """Whether an axis at rest only waits for the end of its time."""
        if self.stop.armed_ns is None or self._rest_ns is None:
            return False
        longest_ns = max(detector.criteria.min_time_ns for _, detector in self._axes)
        if now_ns - self._rest_ns > longest_ns:
            return False  # a lag that flickers about its limit begins anew for ever
        return any(
            detector.may_still_come(axis.port.lag_mm, is_held_off=_is_held_off(axis))
            for axis, detector in self._axes
        )

    # What comes of it

    def _find(self, axis: str, now_ns: TimeNs) -> Order:
        stop, ports = self.stop, self._plan.involved
        stop.detected_ns = self.record.signal_ns = now_ns
        stop.detected_by = axis
        stop.beyond_ns.update(_known((w.port.name, d.beyond_ns) for w, d in self._axes))
        stop.window_ns.update(_known((w.port.name, d.window_ns) for w, d in self._axes))
        stop.set_mm.update({port.name: port.set_mm for port in ports})
        stop.actual_mm.update({port.name: port.actual_mm for port in ports})
        self._state = _State.BRAKING
        return Order.BRAKE

    def _miss(self, now_ns: TimeNs) -> Order:
        """No stop is found: an alarm, or on to where the axes are."""
        if self._plan.is_error:
            raise Alarm(
                900240,
                axes=", ".join(axis.port.name for axis, _ in self._axes),
                criteria="; ".join(self._found(axis, detector) for axis, detector in self._axes),
            )
        return self._relax(now_ns, {port.name: port.actual_mm for port in self._plan.moved})

    def _found(self, axis: Watched, detector: StopDetector) -> str:
        """What was looked for at an axis, and how near it came."""
        begin = f"{axis.port.name} {_in_words(detector.criteria, axis.settings)}"
        if self.stop.armed_ns is None:
            start_mm, path_mm = self.stop.start_distance_mm, self._motion.travelled_mm
            path = f"only from {start_mm:g} mm on and the path was {path_mm:g} mm"
            return f"{begin}, never judged: {path}"
        text = f"{begin}, largest lag {detector.largest_lag_mm:.4f} mm"
        text += f", at rest with {abs(axis.port.lag_mm):.4f} mm"
        if detector.window_ns is not None and not _is_held_off(axis):
            window = f"exact-stop window of {axis.exact_stop_mm:g} mm (P-AXIS-00236)"
            text += f", inside its {window}, where standstill is no stop"
        return text

    def _braking(self, now_ns: TimeNs) -> Order:
        if not self._motion.has_stopped:
            return Order.NONE
        self.stop.brake_end_ns = now_ns
        actual_mm = self.stop.actual_mm
        return self._relax(now_ns, {port.name: actual_mm[port.name] for port in self._plan.moved})

    def _relax(self, now_ns: TimeNs, targets_mm: dict[str, float]) -> Order:
        self.targets_mm, self.stop.relax_begin_ns = targets_mm, now_ns
        self._state = _State.RELAXING
        return Order.RELAX

    def _relaxing(self, now_ns: TimeNs) -> Order:
        if not self._motion.is_in_position():
            return Order.NONE
        if self.stop.detected_ns is not None:
            actual_mm = self.stop.actual_mm
            self.record.latched_mm.update({axis: actual_mm[axis] for axis in self.record.axes})
        self.stop.relax_end_ns = self.record.end_ns = now_ns
        self.abort()
        return Order.NONE


class _SetPath:
    """What the set positions that were sent do; slows: they move less than in the cycle before."""

    def __init__(self, sent: Callable[[], tuple[float, ...]]) -> None:
        self._sent = sent
        self._places = sent()
        self._step_mm = 0.0
        self.rests, self.slows, self.has_moved = True, False, False

    def look(self) -> None:
        """Take what was sent since the last look."""
        places = self._sent()
        step_mm = dist(places, self._places)
        self.rests = places == self._places
        self.has_moved |= not self.rests
        self.slows = step_mm < self._step_mm - SAME_MM
        self._places, self._step_mm = places, step_mm


def _is_held_off(axis: Watched) -> bool:
    return abs(axis.port.lag_mm) > axis.exact_stop_mm


def _known(pairs: Iterable[tuple[str, TimeNs | None]]) -> dict[str, TimeNs]:
    return {name: at_ns for name, at_ns in pairs if at_ns is not None}


def _in_words(criteria: Criteria, settings: FixedStopSettings) -> str:
    """What was looked for, with the reason when it is nothing."""
    lag_mm, window_mm = criteria.lag_limit_mm, criteria.window_mm
    if lag_mm is None and window_mm is None:
        if settings.window_mm is None:
            return "no criterion active (no lag limit and no window)"
        window = f"min_time 0 for its window of {settings.window_mm:g} mm"
        return f"no criterion active (no lag limit, and {window})"
    words = ["no lag limit" if lag_mm is None else f"lag > {lag_mm:g} mm"]
    words.append("no window" if window_mm is None else f"window {window_mm:g} mm")
    return ", ".join((*words, f"min_time {criteria.min_time_ns * MS_PER_NS:g} ms"))
