"""What the encoder of a motor and its telegrams add to a value: noise, and lost positions."""

from functools import cache
from math import cos, log, pi, sqrt

from axisrig.bench.judge.observed.motion import State, state_at
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.oracles.interpolation import cubic
from axisrig.bench.record.signal_sources import STAMPED
from axisrig.bench.rig.settings import Settings
from axisrig.bench.tools.budget.starts import start_number
from axisrig.kernel.time.clock import S, TimeNs

NOISE_PERIOD_S = 100e-6
"""Default of noise_period (PartialAxis, KinematicAxis)."""
_PARTS = 16
_MODULUS = 2**31 - 1
_HIT = " frame"
"""In the words of a mark of a fault: how many telegrams it has hit."""


@cache
def normal_number(place: int, seed: int) -> float:
    """Return number `place` of the sequence of a seed, 0 before the first.

    Two sequences a_k = 16807^k a_0 and b_k = 48271^k b_0 modulo 2^31 - 1 give sqrt(-2 ln(a_k/m))
    cos(2 pi b_k/m). Source: G. E. P. Box, M. E. Muller (1958) with generators of S. K. Park, K. W.
    Miller (1988); first states by the seed as docs/rigs.md has them.
    """
    if place < 1:
        return 0.0
    radius = pow(16807, place, _MODULUS) * (1 + 742938285 * seed % (_MODULUS - 1)) % _MODULUS
    angle = pow(48271, place, _MODULUS) * (1 + 950706376 * seed % (_MODULUS - 1)) % _MODULUS
    return sqrt(-2 * log(radius / _MODULUS)) * cos(2 * pi * angle / _MODULUS)


def noise_number(
    observed: Observed, axis: str, settings: Settings, value_ns: TimeNs, edge_ns: TimeNs | None
) -> float:
    """Return the number of the noise in the position of an instant.

    edge_ns: of the probe, where a drive has latched; it has a cubic between the ends of a fine
    step, and of its 16 parts where the edge is in it (docs/architecture.md, "How exact is an
    edge"): a number that changes within goes over with 3 s^2 - 2 s^3.
    """
    plant = settings.rig.axis[axis].plant
    if not start_number(settings, plant, "noise", 0.0):
        return 0.0
    seed = round(start_number(settings, plant, "seed", 1.0))
    period_ns = round(start_number(settings, plant, "noise_period", NOISE_PERIOD_S) * S)

    def number(at_ns: TimeNs) -> float:
        return normal_number(at_ns // period_ns, seed)

    if not is_stamped(observed, axis):
        if edge_ns is None:
            return number(value_ns)
        sync_ns = observed.sync_ns(axis, observed.sync_index_at(axis, value_ns))
        step_ns, fine_ns = float(observed.facts.fine_ns), observed.facts.fine_ns
        if (edge_ns - sync_ns) // fine_ns == (value_ns - sync_ns) // fine_ns:
            step_ns /= _PARTS
        begin_ns = value_ns - (value_ns - sync_ns) % step_ns
        share = (value_ns - begin_ns) / step_ns
        first, last = number(int(begin_ns)), number(int(begin_ns + step_ns))
        return first + (last - first) * (3 * share**2 - 2 * share**3)
    times_ns = _history_ns(observed, axis, value_ns)
    return sum(
        number(at_ns) * weight
        for at_ns, weight in zip(times_ns, _weights(times_ns, value_ns), strict=True)
    )


def is_stamped(observed: Observed, axis: str) -> bool:
    """Whether the value is of a time stamp, taken from the history of positions."""
    return observed.facts.runs[-1].sources.get(axis, "") == STAMPED


def _history(observed: Observed, axis: str, value_ns: TimeNs) -> list[int]:
    """Return the rows whose positions a cubic is laid through: two before, two after."""
    row = observed.sync_index_at(axis, value_ns)
    return [*range(row - 1, row + 3)]


def _history_ns(observed: Observed, axis: str, value_ns: TimeNs) -> list[TimeNs]:
    """Return the SYNCs of these rows."""
    return [observed.sync_ns(axis, row) for row in _history(observed, axis, value_ns)]


def _true_mm(observed: Observed, axis: str, row: int) -> float:
    """Return where an axis was at the SYNC of its own segment."""
    own_ns = observed.sync_ns(axis, row)
    if own_ns == observed.time_ns(row):
        return observed.value(axis, "truth_mm", row)
    return _state(observed, axis, own_ns).position_mm


def _true_mm_s(observed: Observed, axis: str, row: int) -> float:
    """Return how fast it was then."""
    own_ns = observed.sync_ns(axis, row)
    if own_ns == observed.time_ns(row):
        return observed.value(axis, "velocity_mm_s", row)
    return _state(observed, axis, own_ns).speed_mm_s


def _state(observed: Observed, axis: str, time_ns: TimeNs) -> State:
    state = state_at(observed, axis, time_ns)
    assert state is not None, "a row that was recorded"
    return state


def history_end_ns(observed: Observed, axis: str, value_ns: TimeNs) -> TimeNs:
    """Return the last SYNC whose position is in a value of a time stamp."""
    return _history_ns(observed, axis, value_ns)[-1]


def between_um(observed: Observed, axis: str, value_ns: TimeNs) -> float:
    """Return how far the cubic through the true positions at four SYNCs is off between them.

    0 in constant acceleration; below da T^2/8 where it changes by da.
    """
    times_ns = _history_ns(observed, axis, value_ns)
    rows = _history(observed, axis, value_ns)
    places_mm = [_true_mm(observed, axis, row) for row in rows]
    on_cubic_mm = sum(
        place * weight
        for place, weight in zip(places_mm, _weights(times_ns, value_ns), strict=True)
    )
    begin_mm_s, end_mm_s = (_true_mm_s(observed, axis, row) for row in rows[1:3])
    ends = (places_mm[1], begin_mm_s, places_mm[2], end_mm_s)
    since_s, step_s = (value_ns - times_ns[1]) / S, (times_ns[2] - times_ns[1]) / S
    return (on_cubic_mm - cubic(since_s, step_s, ends)) * 1e3


def _weights(times_ns: list[TimeNs], at_ns: TimeNs) -> list[float]:
    """Return the weights of a cubic through four samples (Lagrange)."""
    found = []
    for own_ns in times_ns:
        weight = 1.0
        for other_ns in times_ns:
            if other_ns != own_ns:
                weight *= (at_ns - other_ns) / (own_ns - other_ns)
        found.append(weight)
    return found


def lost_um(observed: Observed, axis: str, value_ns: TimeNs, *, is_latched: bool) -> float:
    """Return how far a position is off that a cubic through two on either side of lost telegrams
    gives.

    0 where the drive has stored the value, where no telegram of its SYNC was hit, and in constant
    acceleration.
    """
    if is_latched or is_stamped(observed, axis):
        return 0.0
    row = observed.sync_index_at(axis, value_ns)
    for fault in observed.facts.faults:
        for last_ns, words in fault.marks:
            if _HIT not in words:
                continue
            count = int(words.split(": ")[1].split(_HIT)[0])
            last = observed.index_at(last_ns)
            first = last - count + 1
            if first <= row <= last:
                rows = [first - 2, first - 1, last + 1, last + 2]
                weights = _weights([observed.sync_ns(axis, each) for each in rows], value_ns)
                on_cubic_mm = sum(
                    _true_mm(observed, axis, each) * weight
                    for each, weight in zip(rows, weights, strict=True)
                )
                return (on_cubic_mm - _true_mm(observed, axis, row)) * 1e3
    return 0.0
