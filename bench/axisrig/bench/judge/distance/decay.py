"""How fast what nothing excites dies away or grows: the poles that a signal shows.

A loop that nothing excites is a sum of powers z^k of its poles. The matrix pencil finds them from
the signal alone: Y. Hua and T. K. Sarkar, IEEE Transactions on Acoustics, Speech and Signal
Processing 38 (1990) 814. Largest values of two halves would compare different poles: a fast one of
the first half with a slow one of the second, or the kick of a D part with what comes after it.
"""

from typing import NamedTuple

import numpy as np

from axisrig.bench.oracles.errors import NoClosedFormError
from axisrig.bench.record.series import Signal

LEAST = 12
"""Fewer values do not show their poles."""
_PENCIL_MOST, _POLES_MOST = 60, 30
_ABOVE_NOISE = 6.0
"""From the last value so far above the noise on the signal is not looked at any more."""
_VISIBLE = 3.0
"""A pole counts when its part is somewhere so far above the noise."""
_ROUNDS, _EXPLAINED = 6, 1.2
_DOUBTS, _ROUNDING = 2.0, 1e-6
"""Times the difference to the same of the first and of the last three quarters, and the least."""


class Growth(NamedTuple):
    """Magnitude of the largest pole that is seen, its uncertainty, and of how many values."""

    factor: float
    uncertainty: float
    values: int


def growth_of(values: Signal, noise: float) -> Growth | None:
    """Return the growth of a signal, shape (n,), per value; None where too little is above noise.

    noise: standard deviation that its rounding has at least. Where the poles leave more than that
    unexplained, it is the noise, and less of the signal is looked at. Raises NoClosedFormError for
    a signal that no poles explain: something excites it all the time.
    """
    level = noise
    for _ in range(_ROUNDS):
        beyond = np.flatnonzero(np.abs(values) > _ABOVE_NOISE * level)
        count = int(beyond[-1]) + 1 if len(beyond) else 0
        if count < LEAST and level == noise:
            return None
        if count < LEAST:
            break
        factor, left = _largest(values[:count], level)
        if left <= _EXPLAINED * level:
            parts = values[: count - count // 4], values[count // 4 : count]
            doubt = max(abs(factor - _largest(part, level)[0]) for part in parts)
            return Growth(factor, _DOUBTS * doubt + _ROUNDING, count)
        level = left
    raise NoClosedFormError("something excites the offset all the time")


def _largest(values: Signal, noise: float) -> tuple[float, float]:
    """Return the magnitude of the largest pole and what all of them leave unexplained (rms).

    As few poles as explain the values; more would be poles of the noise.
    """
    length = min(len(values) // 2, _PENCIL_MOST)
    windows = np.lib.stride_tricks.sliding_window_view(values, length + 1)
    # The squares of the singular values and their directions, the largest first
    squares, directions = np.linalg.eigh(windows.T @ windows)
    directions = directions[:, ::-1]
    bound = noise * (np.sqrt(len(windows)) + np.sqrt(length + 1))
    most = min(max(int(np.sum(squares > bound**2)), 1), length, _POLES_MOST)
    factor, left = _with(directions[:, :most], values, noise)
    if left > _EXPLAINED * noise:
        return factor, left
    for count in range(1, most):
        fewer, left_of_fewer = _with(directions[:, :count], values, noise)
        if left_of_fewer <= noise:
            return fewer, left_of_fewer
    return factor, left


def _with(directions: Signal, values: Signal, noise: float) -> tuple[float, float]:
    """Return the same with as many poles as directions, shape (length + 1, poles)."""
    poles = np.linalg.eigvals(np.linalg.pinv(directions[:-1]) @ directions[1:])
    powers = poles.astype(np.complex128)[None, :] ** np.arange(len(values))[:, None]
    shares, *_ = np.linalg.lstsq(powers, values.astype(np.complex128), rcond=None)
    left = values - (powers @ shares).real
    largest = np.abs(shares) * np.max(np.abs(powers), axis=0)
    seen = np.abs(poles)[largest > _VISIBLE * noise]
    return float(np.max(seen, initial=0.0)), float(np.sqrt(np.mean(left**2)))
