"""What the filter of the sensor value did: its delay at a step of the surface, and its noise.

The filter gets the distance of CONST_DIST, or the deviation of SET_POS (FCT-M3 5.1, 5.2).
"""

import itertools
from collections.abc import Sequence

import numpy as np

from axisrig.bench.judge.distance.control_stretches import Stretch, runs_of
from axisrig.bench.judge.distance.plant import gap_true_mm
from axisrig.bench.judge.distance.truth import DistanceTruth
from axisrig.bench.oracles.distance.loop import SET_POS
from axisrig.bench.oracles.errors import NoClosedFormError
from axisrig.bench.record.series import Signal

_EVEN_MM = 2e-7
_RISE_MM = 0.1
_LENGTH_MIN = 50


def filtered_mm(truth: DistanceTruth, stretch: Stretch) -> tuple[Signal, Signal]:
    """Return what the filter got in a stretch, and what it made of it."""
    given = truth.gathered(_of_distance if stretch.mode != SET_POS else _of_surface, stretch.rows)
    return given, truth.gathered(lambda part: part["filtered_mm"], stretch.rows)


def _of_distance(truth: DistanceTruth) -> Signal:
    return truth["distance_cnc_mm"]


def _of_surface(truth: DistanceTruth) -> Signal:
    return truth["surface_cnc_mm"] - truth.wanted_mm("set_pos_mm")


def delay_cycles(truth: DistanceTruth, filtered: Sequence[Stretch]) -> float:
    """Return by how many cycles the filter is late: sum of (in - out) over a step / its height.

    For every linear filter of gain 1 that is its group delay at frequency 0. The step: the largest
    change of the surface between two times in which it is at rest. filtered: stretches of one
    filter. Raises NoClosedFormError.
    """
    best = (0.0, 0.0)
    for stretch in filtered:
        given, out = filtered_mm(truth, stretch)
        flats = _flats(truth, stretch)
        for (begin, end), (top_begin, top_end) in itertools.pairwise(flats):
            # From the middle of one flat to the end of the next: the filter has settled in both
            first = (begin + end) // 2
            before, after = np.mean(given[first:end]), np.mean(given[top_begin:top_end])
            rise = float(after - before)
            if abs(rise) > max(_RISE_MM, abs(best[0])):
                best = rise, float(np.sum((given - out)[first:top_end]))
    if not best[0]:
        raise NoClosedFormError("the surface never stepped from one level to another")
    return best[1] / best[0]


def noise_gain(
    truth: DistanceTruth, filtered: Sequence[Stretch], settling_cycles: int
) -> tuple[float, int]:
    """Return standard deviation after over that before the filter, and from how many cycles.

    filtered: stretches of one filter. settling_cycles: left out at the begin of each time in which
    the surface is at rest. Raises NoClosedFormError without noise.
    """
    given_parts, out_parts = [], []
    for stretch in filtered:
        given, out = filtered_mm(truth, stretch)
        for begin, end in _flats(truth, stretch):
            rows = slice(begin + settling_cycles, end)
            if end - rows.start >= _LENGTH_MIN:
                given_parts.append(given[rows] - np.mean(given[rows]))
                out_parts.append(out[rows] - np.mean(out[rows]))
    if not given_parts:
        raise NoClosedFormError(
            f"the surface was never at rest for {settling_cycles + _LENGTH_MIN} cycles"
        )
    given, out = np.concatenate(given_parts), np.concatenate(out_parts)
    if not np.std(given) > 0:
        raise NoClosedFormError("the sensor has no noise")
    return float(np.std(out) / np.std(given)), len(given)


def _flats(truth: DistanceTruth, stretch: Stretch) -> list[tuple[int, int]]:
    """Rows of a stretch in which the true distance is constant, counted from its begin."""
    gap = truth.gathered(gap_true_mm, stretch.rows)
    stands = np.abs(np.diff(gap, prepend=gap[:1])) <= _EVEN_MM
    return [(begin, end) for begin, end in runs_of(stands) if end - begin >= _LENGTH_MIN]
