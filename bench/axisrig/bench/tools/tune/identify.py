"""Impulse response of a path from recorded signals, with noise.

Least squares with a prior that is smooth and dies away (the TC kernel of T. Chen, H. Ohlsson and
L. Ljung, On the estimation of transfer functions, regularizations and Gaussian processes,
Automatica 48 (2012) 1525): h ~ N(0, c r^max(i, j)); c and r by marginal likelihood. Without noise
it is plain least squares.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.linalg import LinAlgError, cho_factor, cho_solve, qr, toeplitz

Floats = npt.NDArray[np.float64]
Flags = npt.NDArray[np.bool_]

_DECAYS = (0.3, 0.6, 0.8, 0.9, 0.95, 0.98, 0.995)
_SCALES = (1e-4, 1e-3, 1e-2, 0.1, 1.0)
# What is left of the rest position counts as answered
BEGUN, SETTLED = 0.05, 0.98
# A pure delay is taken when it leaves no more than this times what the full answer leaves
_AS_GOOD = 1.05
_BLOCK = 12


@dataclass(frozen=True)
class Path:
    """Answer of a signal to a pulse of the offset, from cycle 0 on.

    sigma_mm: standard deviation of the signal at rest. misfit_mm: of what the answer leaves
    unexplained. renewal_cycles: every how many cycles the signal is new.
    """

    impulses: Floats
    sigma_mm: float
    misfit_mm: float
    renewal_cycles: int = 1

    @property
    def gain(self) -> float:
        """What is left of an offset that stays."""
        return float(self.impulses.sum())

    @property
    def first_cycle(self) -> int:
        """Cycles from an offset until the signal has begun to answer (5 % of the end)."""
        return self._cycle(BEGUN)

    @property
    def settled_cycle(self) -> int:
        """Cycles until 98 % of the end are there."""
        return self._cycle(SETTLED)

    @property
    def mean_cycle(self) -> float:
        """Centre of the answer: the delay on a ramp, in cycles."""
        return float(np.arange(len(self.impulses)) @ self.impulses / self.gain)

    @property
    def is_dead_time(self) -> bool:
        """Whether the answer is one whole pulse, so that closed forms hold (within 2 %)."""
        rest = self.impulses.copy()
        rest[self.first_cycle] -= 1
        return bool(np.abs(rest).sum() < 0.02)

    def _cycle(self, share: float) -> int:
        return int(np.argmax(np.cumsum(self.impulses) >= share * self.gain))


def identify(
    offset_mm: Floats, signal_mm: Floats, begin: int, cycles: int, fresh: Flags | None = None
) -> Path:
    """Find the impulse response of signal to offset, 0 in the cycle of the offset itself.

    offset_mm, signal_mm: by cycles; both rest before `begin`, the first cycle in which the offset
    has moved. cycles: length of the answer. fresh: cycles whose signal counts, None for all. The
    signal at rest shows its noise.

    The offset may depend on the signal (closed loop): its noise is then found in later offsets
    only, and what comes out is right as long as the offset cannot act in its own cycle.
    """
    rest = signal_mm[:begin]
    sigma_mm = float(np.std(rest))
    u = offset_mm[begin:] - offset_mm[begin - 1]
    rows = slice(None) if fresh is None else fresh[begin:]
    y = (signal_mm[begin:] - float(np.mean(rest)))[rows]
    # The first column, an answer in the cycle of the offset, is left out
    regressors = toeplitz(u, np.zeros(min(cycles, len(u))))[rows, 1:]
    floor_mm = max(sigma_mm, _rounding_mm(signal_mm), 1e-7 * float(np.abs(y).max()))
    answer = _posterior(regressors, y, floor_mm**2)
    misfit_mm = float(np.std(y - regressors @ answer))
    delay = _pure_delay(regressors, y)
    delayed_mm = float(np.std(y - regressors @ delay))
    if delayed_mm <= _AS_GOOD * max(misfit_mm, floor_mm):
        answer, misfit_mm = delay, delayed_mm
    return Path(np.concatenate([[0.0], answer]), sigma_mm, misfit_mm)


def renewal_cycles(offset_mm: Floats, signal_mm: Floats, begin: int) -> int:
    """Return every how many cycles a signal is renewed, from where the offset moves it much."""
    moves = np.abs(np.diff(offset_mm[begin:]))
    rows = np.flatnonzero(moves > moves.max() / 20) + begin + 1
    # What an offset moves is seen some cycles later: the changes of a block of cycles count
    blocks = [signal_mm[row : row + _BLOCK + 1] for row in rows if row + _BLOCK < len(signal_mm)]
    changes = np.mean([np.count_nonzero(np.diff(block)) / _BLOCK for block in blocks])
    return max(round(1 / max(float(changes), 1 / _BLOCK)), 1)


def _rounding_mm(signal_mm: Floats) -> float:
    """Standard deviation by which set position and encoder are rounded, whatever the rest shows.

    Each is spread evenly over an increment, which is the smallest change of the signal.
    """
    changes = np.abs(np.diff(signal_mm))
    moved = changes[changes > 1e-9 * np.abs(signal_mm).max()]
    return float(moved.min()) / 6**0.5 if moved.size else 0.0


def _pure_delay(regressors: Floats, y: Floats) -> Floats:
    """Find the one pulse that explains y best: a path that only delays."""
    shares = regressors.T @ y / np.maximum(np.sum(regressors**2, axis=0), 1e-300)
    left = np.sum((y[:, None] - regressors * shares) ** 2, axis=0)
    at = int(np.argmin(left))
    impulses = np.zeros(regressors.shape[1])
    impulses[at] = shares[at]
    return impulses


def _posterior(regressors: Floats, y: Floats, variance: float) -> Floats:
    """Mean of h given y, for the c and r of the greatest likelihood.

    An orthogonal transformation leaves noise and likelihood as they are, so the triangle of a QR
    decomposition represents all rows.
    """
    length = regressors.shape[1]
    triangle = qr(np.column_stack([regressors, y]), mode="r")[0][: length + 1]
    regressors, y = triangle[:, :length], triangle[:, length]
    latest = np.maximum.outer(np.arange(length), np.arange(length))
    best = (-np.inf, np.zeros(length))
    for decay in _DECAYS:
        product = decay**latest @ regressors.T
        spread = regressors @ product
        for scale in _SCALES:
            covariance = scale * spread
            covariance[np.diag_indices(len(y))] += variance
            try:
                factor = cho_factor(covariance, lower=True)
            except LinAlgError:
                continue
            solved = cho_solve(factor, y)
            likelihood = -float(y @ solved) / 2 - float(np.log(np.diag(factor[0])).sum())
            if likelihood > best[0]:
                best = (likelihood, scale * product @ solved)
    return best[1]
