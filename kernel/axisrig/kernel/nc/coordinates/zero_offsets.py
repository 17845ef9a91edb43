"""Zero offsets G53 to G59 and G159: groups of one offset per axis."""

from collections.abc import Iterable
from dataclasses import dataclass, field

from axisrig.kernel.nc.coordinates.lists import Entry
from axisrig.kernel.parameters.units import UNITS_PER_MM

GROUPS = 97
NONE = 0


@dataclass
class ZeroOffsets:
    """The table for G54 to G59 (groups 1 to 6), G159 and V.G.NP[].

    offsets_mm: by (group, axis index), as written. inactive: pairs that do not act. group_0_acts:
    P-ZERO-00001. default_group: in use when a program begins, P-ZERO-00002.
    """

    offsets_mm: dict[tuple[int, int], float] = field(default_factory=dict)
    inactive: set[tuple[int, int]] = field(default_factory=set)
    group_0_acts: bool = False
    default_group: int = NONE

    def set(self, entry: Entry) -> None:
        """Take one value of a list."""
        match entry.path:
            case "g53_verfuegbar":
                self.group_0_acts = bool(entry.value)
            case "default_index":
                self.default_group = int(entry.value)
            case "np_grp[i].achse[j].versch":
                group, axis = entry.indices
                self.offsets_mm[group, axis] = float(entry.value) / UNITS_PER_MM
            case "np_grp[i].achse[j].inaktiv":
                group, axis = entry.indices
                (self.inactive.add if entry.value else self.inactive.discard)((group, axis))

    def shift_mm(self, group: int, axis: int) -> float:
        """Give what acts on an axis when the group is selected."""
        acts = (group != NONE or self.group_0_acts) and (group, axis) not in self.inactive
        return self.offsets_mm.get((group, axis), 0.0) if acts else 0.0

    def copy(self) -> "ZeroOffsets":
        """Make a table that a program may write without changing this one."""
        return ZeroOffsets(
            dict(self.offsets_mm), set(self.inactive), self.group_0_acts, self.default_group
        )


def make_zero_offsets(entries: Iterable[Entry]) -> ZeroOffsets:
    """Make the table from the values of a list."""
    table = ZeroOffsets()
    for entry in entries:
        table.set(entry)
    return table
