"""Which causes act on each other, and their shares: means over the orders of switching them off."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from itertools import combinations, pairwise
from math import comb

MOST = 256
"""Runs in combination at most: 2^8."""
USUAL = 64
"""So many, where nobody says more: 2^6."""

Make = Callable[[Iterable[frozenset[int]]], None]
"""Makes runs with causes off."""
ErrorUm = Callable[[Iterable[int]], float]
"""Gives the error of a run with causes off."""


@dataclass(frozen=True)
class Combined:
    """What the combinations gave; causes by their places.

    shares_um: they add up to the error less what is left. interacting: those whose share depends on
    the others by more than the tolerance. left_out: of groups that need more runs than allowed,
    those that were switched off in turn only.
    """

    shares_um: dict[int, float]
    interacting: frozenset[int] = frozenset()
    left_out: frozenset[int] = frozenset()


@dataclass(frozen=True)
class Runs:
    """Runs of a row with causes off. count: of the causes. apart: those that are off throughout,
    as the rounding to increments, which would show in every difference.
    """

    count: int
    make: Make
    error_um: ErrorUm
    apart: frozenset[int] = frozenset()

    @property
    def places(self) -> list[int]:
        """The causes that are looked at, in their order."""
        return [place for place in range(self.count) if place not in self.apart]

    def off(self, on: Iterable[int]) -> frozenset[int]:
        """Return what is off where these are on."""
        return frozenset(range(self.count)) - frozenset(on)

    def on_um(self, on: Iterable[int]) -> float:
        """Return the error with these on alone."""
        return self.error_um(self.off(on))

    def make_on(self, sets: Iterable[Iterable[int]]) -> None:
        """Make the runs with these on alone."""
        self.make([self.off(on) for on in sets])


def groups(runs: Runs, tolerance_um: float) -> list[list[int]]:
    """Return the causes in groups of neighbours; none acts on one of another group.

    Between two groups the causes of both sides add up: e(all) - e(before) - e(after) + e(none) is
    0, within a tolerance. So 2 n runs are enough to see where any acts on another; a pair for pair
    comparison needs n^2/2 and does not see what needs three.
    """
    places = runs.places
    cuts = range(1, len(places))
    runs.make_on([*(places[:cut] for cut in cuts), *(places[cut:] for cut in cuts), [], places])
    both_um = runs.on_um(places) + runs.on_um([])
    free = [
        cut
        for cut in cuts
        if abs(both_um - runs.on_um(places[:cut]) - runs.on_um(places[cut:])) <= tolerance_um
    ]
    return [places[begin:end] for begin, end in pairwise([0, *free, len(places)]) if begin < end]


def combined(runs: Runs, tolerance_um: float, most: int = USUAL) -> Combined:
    """Return the shares of the causes that are not apart.

    most: so many runs in combination for all groups together, the smallest group first.

    The causes of a group are combined with all groups before on and all after off, so that the
    shares add up. The share is the mean of what a cause adds over all orders in which those of its
    group can come: that of Shapley (A value for n-person games, 1953), the mean over the sets S
    of the others of e(S with it) - e(S), each number of causes in S with the same weight. Where a
    group needs too many runs, those that depend least on the others are switched off in turn.
    """
    found = groups(runs, tolerance_um)
    shares_um: dict[int, float] = {}
    interacting: set[int] = set()
    left_out: set[int] = set()
    remaining = min(most, MOST)
    for group in sorted(found, key=len):
        before = [place for place in runs.places if place < group[0]]
        size = min(len(group), max(remaining, 1).bit_length() - 1)
        chosen = group if size == len(group) else _strongest(runs, before, group, size)
        if len(group) > 1:
            remaining -= 2 ** len(chosen) if chosen else 0
            left_out.update(place for place in group if place not in chosen)
        of_group, depending = _of_group(runs, before, group, chosen, tolerance_um)
        shares_um |= of_group
        interacting |= depending
    return Combined(shares_um, frozenset(interacting), frozenset(left_out))


def _strongest(runs: Runs, before: list[int], group: list[int], size: int) -> list[int]:
    """Return those whose share depends most on which others of their group are on."""
    if size < 2:
        return []
    runs.make_on([*([*before, place] for place in group)])
    runs.make_on([[*before, *(other for other in group if other != place)] for place in group])
    whole_um, none_um = runs.on_um([*before, *group]), runs.on_um(before)

    def depends_um(place: int) -> float:
        begin = group.index(place)
        first_um = runs.on_um([*before, place]) - none_um
        last_um = whole_um - runs.on_um([*before, *(other for other in group if other != place)])
        in_turn_um = runs.on_um([*before, *group[: begin + 1]])
        in_turn_um -= runs.on_um([*before, *group[:begin]])
        sizes_um = first_um, last_um, in_turn_um
        return max(sizes_um) - min(sizes_um)

    return sorted(sorted(group, key=depends_um, reverse=True)[:size])


def _of_group(
    runs: Runs, before: list[int], group: list[int], chosen: Sequence[int], tolerance_um: float
) -> tuple[dict[int, float], set[int]]:
    """Return the shares of a group, and those that depend on the others.

    Those that are not chosen are switched off one after the other from the last one on, with the
    chosen ones on; then come all sets of the chosen ones.
    """
    others = [place for place in group if place not in chosen]
    in_turn = [[*before, *chosen, *others[:count]] for count in range(len(others) + 1)]
    sets = [frozenset(on) for size in range(len(chosen) + 1) for on in combinations(chosen, size)]
    runs.make_on([*in_turn, *([*before, *on] for on in sets)])
    shares_um = {
        place: runs.on_um(with_it) - runs.on_um(without)
        for place, without, with_it in zip(others, in_turn, in_turn[1:], strict=False)
    }
    depending: set[int] = set()
    for place in chosen:
        adds_um = [
            (len(on), runs.on_um([*before, *on, place]) - runs.on_um([*before, *on]))
            for on in sets
            if place not in on
        ]
        shares_um[place] = sum(
            size_um / (len(chosen) * comb(len(chosen) - 1, count)) for count, size_um in adds_um
        )
        sizes_um = [size_um for _, size_um in adds_um]
        if max(sizes_um) - min(sizes_um) > tolerance_um:
            depending.add(place)
    return shares_um, depending
