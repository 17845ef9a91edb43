"""Shares of causes that act on each other: means over all orders of switching them off."""

from collections.abc import Callable, Iterable, Sequence
from itertools import combinations
from math import comb

MOST = 8
"""Causes that are combined: 2^8 runs at most."""


def combined(
    acting: Sequence[int],
    count: int,
    make: Callable[[Iterable[frozenset[int]]], None],
    error_um: Callable[[Iterable[int]], float],
) -> dict[int, float]:
    """Return the share of each of `count` causes, um; they add up to the error less what is left.

    acting: places of those that act on each other, the strongest first; the first MOST are
    combined. make: runs with causes off; error_um: the error of such a run.

    The others are switched off one after the other from the last one on. With them off, the share
    of a cause is the mean of what it adds over all orders in which the causes can come: that of
    Shapley (A value for n-person games, 1953), the mean over the sets S of the others of
    e(S with it) - e(S), each number of causes in S with the same weight.
    """
    group = list(acting)[:MOST]
    others = [place for place in range(count) if place not in group]
    in_turn = [frozenset(others[begin:]) for begin in range(len(others) + 1)]
    sets = [frozenset(on) for size in range(len(group) + 1) for on in combinations(group, size)]
    every = frozenset(range(count))
    make([*in_turn, *(every - on for on in sets)])
    shares = {
        place: error_um(later) - error_um(off)
        for place, off, later in zip(others, in_turn, in_turn[1:], strict=False)
    }
    for place in group:
        shares[place] = sum(
            (error_um(every - on - {place}) - error_um(every - on))
            / (len(group) * comb(len(group) - 1, len(on)))
            for on in sets
            if place not in on
        )
    return shares
