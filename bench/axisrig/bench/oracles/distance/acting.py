"""What a distance control acts with: the list, then words of the program, then CNC objects.

Rules, in the cycles of the NC:

- a word of the program acts from the cycle after its own on, a command of it too; a command of the
  PLC side in its own cycle (docs/architecture.md, "From a sensor value to the offset")
- what a CNC object is given acts when the control is switched on from INACTIVE or FREEZE the next
  time (FCT-M3 7.6), or out of a dry run, which is as FREEZE
- of word and object the one that was given later counts (docs/ambiguities.md)
- FILTER_TIME is as many values as cycles it lasts (docs/ambiguities.md)
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field

from axisrig.bench.oracles.distance.lists import Listed, Written, as_written, cycles_of
from axisrig.kernel.time.clock import TimeNs

NC, PLC, OBJECT = "NC", "PLC", "OBJECT"
SWITCHES_ON = ("ON", "ON_CONST_DIST")
_FILTER_TIME, _FILTER_TYPE = "filter_time_s", "filter_type"
_OLDER_FILTER = "low_pass_filter_enable"


@dataclass(frozen=True)
class Order:
    """What was asked in the cycle of a row. by: NC, PLC or OBJECT.

    action: ON, ON_CONST_DIST, OFF, FREEZE; empty where only words are given. words: parameters by
    their names in the list, after its structure and in its unit, and filter_time_s.
    """

    row: int
    by: str
    action: str = ""
    is_dry_run: bool = False
    words: Mapping[str, object] = field(default_factory=dict)

    @property
    def acts_from(self) -> int:
        """First cycle whose step it acts in."""
        return self.row + 1 if self.by == NC else self.row


@dataclass(frozen=True)
class Acting:
    """What acts from the step of a row on.

    listed: as the list would say it. begins: the control begins to follow in it.
    """

    row: int
    listed: Listed
    is_dry_run: bool = False
    begins: bool = False


def acting(
    written: Written,
    stems: tuple[str, ...],
    orders: Iterable[Order],
    period_ns: TimeNs,
    follows_in: Callable[[int], bool],
) -> list[Acting]:
    """Return what acts from which row on, in their order; the first from row 0 on.

    written, stems: as of `as_written`. orders: in the order in which they were given. follows_in:
    whether the control is on at the end of the cycle of a row.
    """
    whole, asked = dict(written), dict[str, object]()
    found = [Acting(0, as_written(whole, stems))]
    row, follows, is_dry = -1, False, False
    for order in orders:
        if order.row != row:
            row, follows = order.row, order.row > 0 and follows_in(order.row - 1)
        words = _listed(order.words, period_ns)
        if order.by == OBJECT:
            asked.update(words)
            continue
        if not (words or order.action):
            continue
        begins = order.action in SWITCHES_ON and (not follows or is_dry)
        if begins:
            words, asked = {**asked, **words}, {}
        asked = {name: value for name, value in asked.items() if name not in words}
        whole.update({stems[0] + name: value for name, value in words.items()})
        if order.action:
            follows = order.action in SWITCHES_ON
            is_dry = follows and order.is_dry_run
        _put(found, Acting(order.acts_from, as_written(whole, stems), is_dry, begins))
    return found


def _put(found: list[Acting], new: Acting) -> None:
    """Add what acts from a row on; the last of a row is what acts there."""
    begins = new.begins
    if found[-1].row == new.row:
        begins = found.pop().begins or begins
    found.append(Acting(new.row, new.listed, new.is_dry_run, begins))


def _listed(words: Mapping[str, object], period_ns: TimeNs) -> dict[str, object]:
    """Return words as the list has them."""
    found = dict(words)
    time_s = found.pop(_FILTER_TIME, None)
    if time_s is not None:
        assert isinstance(time_s, int | float)
        found["n_cycles"] = round(cycles_of(time_s, period_ns))
    if _FILTER_TYPE in found:
        found[_OLDER_FILTER] = 0  # it is for a filter that nobody has chosen
    return found
