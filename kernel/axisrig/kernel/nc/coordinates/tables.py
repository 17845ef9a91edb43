"""What a rig says about coordinates before a program begins."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from axisrig.kernel.kinematics import KinematicData
from axisrig.kernel.nc.coordinates.circle import DEFAULT_LIMITS, CircleLimits
from axisrig.kernel.nc.coordinates.lists import TOOLS, ZERO_OFFSETS, Entry, read_entries, read_entry
from axisrig.kernel.nc.coordinates.tools import Tools, make_tools
from axisrig.kernel.nc.coordinates.zero_offsets import ZeroOffsets, make_zero_offsets
from axisrig.kernel.parameters import Origin


@dataclass(frozen=True)
class OffsetTables:
    """Zero offsets, tools and what decides on their use.

    rotary: axes in degrees, which have no inch. ball_radius_counts: the radius of the tool is in
    V.A.MEAS.PCS.VALUE (P-CHAN-00311 = 0). circle: how exact an arc must be. kinematics:
    parameters that the list of the channel has of them. cycle_changes_modal: what a cycle changes
    of the modal state stays (P-CHAN-00210 = 1).
    """

    zero_offsets: ZeroOffsets = field(default_factory=ZeroOffsets)
    tools: Tools = field(default_factory=Tools)
    rotary: frozenset[str] = frozenset()
    ball_radius_counts: bool = True
    circle: CircleLimits = DEFAULT_LIMITS
    kinematics: KinematicData = field(default_factory=KinematicData)
    cycle_changes_modal: bool = False


@dataclass
class Lists:
    """The values of the two lists: from files first, then single ones (`set:` of a plan)."""

    entries: dict[str, list[Entry]] = field(default_factory=lambda: {ZERO_OFFSETS: [], TOOLS: []})

    def read(self, name: str, path: str | Path) -> None:
        """Take the values of a list file. Raises UserError with file, line and column."""
        self.entries[name] += [entry for entry, _ in read_entries(name, path)]

    def set(self, name: str, path: str, text: str, origin: Origin) -> None:
        """Take one value. Raises UserError."""
        self.entries[name].append(read_entry(name, path, text, origin))

    def tables(
        self,
        *,
        rotary: Sequence[str],
        ball_radius_counts: bool,
        circle: CircleLimits = DEFAULT_LIMITS,
        kinematics: KinematicData | None = None,
        cycle_changes_modal: bool = False,
    ) -> OffsetTables:
        """Make the tables of one run."""
        return OffsetTables(
            make_zero_offsets(self.entries[ZERO_OFFSETS]),
            make_tools(self.entries[TOOLS]),
            frozenset(rotary),
            ball_radius_counts,
            circle,
            kinematics or KinematicData(),
            cycle_changes_modal,
        )
