"""When the criteria of a run to a fixed stop come true: closed forms, with what blurs them.

Symbols: v feed into the stop, t_c contact, e0 running lag, L lag limit, tau minimum time, W window,
delta static penetration, T cycle, d P-AXIS-00191, n1, n2 cycles by which set values act and
actual values come late. Derivation: the set value goes on with v while the axis is at rest at
delta, so e(t) = e0 + v (t - t_c) - delta, and |x(t) - x(t - tau)| = delta + v (t_c + tau - t) for
t - tau before the contact.
"""

import math
from dataclasses import dataclass, replace

from axisrig.bench.oracles.errors import NoClosedFormError
from axisrig.kernel.time.clock import S, TimeNs

# An RPDO acts at the next SYNC; the telegram of a SYNC is read in the cycle of that SYNC
SET_CYCLES, ACTUAL_CYCLES = 1, 0


@dataclass(frozen=True)
class Cycles:
    """Time base of the rig.

    age_ns: least and largest time from the SYNC on the wire to the NC cycle that reads its actual
    positions. delay_cycles: P-AXIS-00191; buffer_cycles: between interpolator and drive.
    """

    period_ns: TimeNs
    age_ns: tuple[TimeNs, TimeNs]
    delay_cycles: int = 0
    buffer_cycles: int = 0

    @property
    def judged(self) -> "Cycles":
        """Return the same for lags that are judged: before s(k) is made d = 0 counts as 1."""
        return replace(self, delay_cycles=max(self.delay_cycles, 1))

    @property
    def way_cycles(self) -> int:
        """Cycles from a set value that is sent to the SYNC at which the demand has reached it."""
        return SET_CYCLES + ACTUAL_CYCLES + 1

    def up(self, time_ns: TimeNs) -> int:
        """Return a time in cycles, rounded up."""
        return -(-time_ns // self.period_ns)


@dataclass(frozen=True)
class Instant:
    """An instant of the closed form and the band in which an NC cycle must report it (ns).

    doubt_ns: share of the band that is no sampling. note: the formula, and what the band is made
    of; where there is no instant, why.
    """

    time_ns: float | None
    low_ns: float | None = None
    high_ns: float | None = None
    note: str = ""
    doubt_ns: float = 0.0

    def holds(self, measured_ns: TimeNs) -> bool:
        """Whether a measured instant is in the band."""
        assert self.low_ns is not None
        assert self.high_ns is not None
        return self.low_ns <= measured_ns <= self.high_ns


class FreeMotionError(NoClosedFormError):
    """The criterion holds in free motion already."""


def none(note: str) -> Instant:
    """Return the instant that the closed form cannot give."""
    return Instant(None, note=note)


def running_lag_mm(speed_mm_s: float, kv_per_s: float, share: float, cycles: Cycles) -> float:
    """Return the lag that the CNC sees in steady motion, e0 = (1 - f) v/Kv + (n1 + n2 + 1 - d) v T.

    share: f of the velocity feed-forward. Negative when d over-compensates.
    Source: P position loop with linear interpolation in the drive.
    """
    return (1.0 - share) * speed_mm_s / kv_per_s + bus_lag_mm(speed_mm_s, cycles)


def bus_lag_mm(speed_mm_s: float, cycles: Cycles) -> float:
    """Return the part of the running lag that the cycles make."""
    late = cycles.way_cycles - cycles.delay_cycles
    return late * speed_mm_s * cycles.period_ns / S


@dataclass(frozen=True)
class Approach:
    """How an axis has met its stop.

    doubt_ns: of the contact. armed_ns: no criterion counts before, None = never reached.
    """

    contact_ns: float
    doubt_ns: float
    speed_mm_s: float
    running_lag_mm: float
    penetration_mm: float
    armed_ns: float | None = None

    def lag_exceeded_ns(self, limit_mm: float) -> float:
        """Return t_L = t_c + (L - e0 + delta)/v."""
        way_mm = limit_mm - self.running_lag_mm + self.penetration_mm
        return self.contact_ns + way_mm / self.speed_mm_s * S

    def window_true_ns(self, window_mm: float, min_time_ns: TimeNs) -> float:
        """Return t_W = t_c + tau - (W - delta)/v."""
        way_mm = window_mm - self.penetration_mm
        return self.contact_ns + min_time_ns - way_mm / self.speed_mm_s * S


def seen(time_ns: float, doubt_ns: float, cycles: Cycles, what: str) -> Instant:
    """Return an instant of continuous time as the NC cycles can see it.

    The first SYNC after it samples the position, up to T later; the cycle of that SYNC judges.
    """
    low_ns, high_ns = cycles.age_ns
    return Instant(
        time_ns,
        time_ns + low_ns - doubt_ns,
        time_ns + high_ns + cycles.period_ns + doubt_ns,
        f"{what}; sampling 0 .. {cycles.period_ns / 1e6:g} ms, age of the position"
        f" {high_ns / 1e6:.3g} ms, doubt {doubt_ns / 1e6:.3g} ms",
        doubt_ns,
    )


def after(begin: Instant, min_time_ns: TimeNs, cycles: Cycles, what: str) -> Instant:
    """Return the instant at which something has held for a time, in whole cycles, rounded up."""
    if begin.time_ns is None or begin.low_ns is None or begin.high_ns is None:
        return begin
    lasting_ns = cycles.up(min_time_ns) * cycles.period_ns
    return Instant(
        begin.time_ns + lasting_ns,
        begin.low_ns + lasting_ns,
        begin.high_ns + lasting_ns,
        f"{what}; {begin.note}",
        begin.doubt_ns,
    )


def later(first: Instant, second: Instant) -> Instant:
    """Return the later one of two criteria that must both hold."""
    if first.time_ns is None or first.low_ns is None or first.high_ns is None:
        return first
    if second.time_ns is None or second.low_ns is None or second.high_ns is None:
        return second
    late = first if first.time_ns >= second.time_ns else second
    return Instant(
        late.time_ns,
        max(first.low_ns, second.low_ns),
        max(first.high_ns, second.high_ns),
        f"the later of both criteria: {late.note}",
        late.doubt_ns,
    )


def least_path_mm(window_mm: float, min_time_ns: TimeNs, acceleration_mm_s2: float) -> float:
    """Return s_min = (a/2) (W/(a tau) + tau/2)^2: path from which the window cannot hold any more.

    In a ramp from standstill the way of the last tau is a tau t - a tau^2/2; it exceeds W from
    t = W/(a tau) + tau/2 on (t >= tau; below that the way is a t^2/2 and W is reached at once).
    """
    tau_s = min_time_ns / S
    since_s = window_mm / (acceleration_mm_s2 * tau_s) + tau_s / 2.0
    if since_s < tau_s:  # the window exceeds before one tau has gone by
        since_s = math.sqrt(2.0 * window_mm / acceleration_mm_s2)
    return 0.5 * acceleration_mm_s2 * since_s**2
