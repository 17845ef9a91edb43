"""Wires of distance sensors: what a sensor reports, or what its cable makes of it."""

import random

from axisrig.bench.machine.wiring.window import Span
from axisrig.kernel.cosim.plant.distance import PlantDistance, Reported
from axisrig.kernel.time.clock import Clock, S, TimeNs


class DistanceFault:
    """Passes a distance as it is; a kind of fault derives its own from it. span: when it acts."""

    def __init__(self, clock: Clock) -> None:
        self.span, self._clock = Span(), clock

    def begin(self) -> None:
        """Let it act from now on."""
        self.span.begin_ns = self._clock.now_ns

    def end(self) -> None:
        """Let it act no more."""
        self.span.end_ns = self._clock.now_ns

    def seen_m(self, time_ns: TimeNs, distance_m: float) -> float:
        """Return what is seen of a distance at an instant."""
        if not self.span.holds(time_ns):
            self._look(distance_m)
            return distance_m
        begin_ns = self.span.begin_ns
        assert begin_ns is not None
        return self._bent_m(time_ns - begin_ns, distance_m)

    def _look(self, distance_m: float) -> None:
        """Look at a distance that is passed."""

    def _bent_m(self, since_ns: TimeNs, distance_m: float) -> float:
        """Return what is seen so long after the begin."""
        return distance_m


class Drift(DistanceFault):
    """The value goes away from the distance at a constant rate."""

    def __init__(self, clock: Clock, um_per_s: float) -> None:
        super().__init__(clock)
        self._um_per_s = um_per_s

    def _bent_m(self, since_ns: TimeNs, distance_m: float) -> float:
        return distance_m + self._um_per_s * 1e-6 * since_ns / S


class Freeze(DistanceFault):
    """The value stays as it was seen last."""

    def __init__(self, clock: Clock) -> None:
        super().__init__(clock)
        self._last_m: float | None = None

    def _look(self, distance_m: float) -> None:
        self._last_m = distance_m

    def _bent_m(self, since_ns: TimeNs, distance_m: float) -> float:
        self._last_m = distance_m if self._last_m is None else self._last_m
        return self._last_m


class Spikes(DistanceFault):
    """Single values are off by so much, up or down. share: of the values. numbers: draws them."""

    def __init__(self, clock: Clock, um: float, share: float, numbers: random.Random) -> None:
        super().__init__(clock)
        self._um, self._share, self._random = um, share, numbers
        self._drawn: dict[TimeNs, float] = {}

    def _bent_m(self, since_ns: TimeNs, distance_m: float) -> float:
        if since_ns not in self._drawn:  # asked twice for one instant it is the same
            is_off = self._random.random() < self._share
            self._drawn[since_ns] = self._random.choice((-1.0, 1.0)) * self._um * is_off
        return distance_m + self._drawn[since_ns] * 1e-6


class EndValue(DistanceFault):
    """The value is that of the end of the range, whatever the distance."""

    def __init__(self, clock: Clock, um: float) -> None:
        super().__init__(clock)
        self._end_m = um * 1e-6

    def _bent_m(self, since_ns: TimeNs, distance_m: float) -> float:
        return self._end_m


class DistanceWire:
    """What comes of a distance sensor after its faults, in their order."""

    def __init__(self, sensor: PlantDistance, clock: Clock) -> None:
        self._sensor, self._clock = sensor, clock
        self.faults: list[DistanceFault] = []

    def reported_at(self, time_ns: TimeNs) -> Reported:
        """Return distance, true distance, validity and touch at an instant, as the sensor does."""
        distance_m, *others = self._sensor.reported_at(time_ns)
        return (self.seen_m(time_ns, distance_m), *others)  # type: ignore[return-value]

    def seen_m(self, time_ns: TimeNs, distance_m: float) -> float:
        """Return what is seen of a distance at an instant."""
        for fault in self.faults:
            distance_m = fault.seen_m(time_ns, distance_m)
        return distance_m
