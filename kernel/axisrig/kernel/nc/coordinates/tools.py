"""Tools: length, radius and axis offsets, as D takes them in."""

from collections.abc import Iterable
from dataclasses import dataclass, field, replace

from axisrig.kernel.nc.coordinates.lists import INCH_MM, UNITS_PER_INCH, Entry
from axisrig.kernel.parameters.units import UNITS_PER_MM

TOOLS = 201


@dataclass
class Tool:
    """The data of one tool, in mm.

    offsets_mm: by axis index; they count against the axis (TF5200 HLI 174744587). fixed:
    P-TOOL-00010, the tool keeps the directions of the axes under #CS.
    """

    length_mm: float = 0.0
    radius_mm: float = 0.0
    offsets_mm: dict[int, float] = field(default_factory=dict)
    fixed: bool = False
    valid: bool = False

    def copy(self) -> "Tool":
        """Make data that a program may write without changing these."""
        return replace(self, offsets_mm=dict(self.offsets_mm))


class Tools:
    """The tools for D and V.G.WZ[], by number; 0 is no tool."""

    def __init__(self, tools: dict[int, Tool] | None = None) -> None:
        self._tools = tools or {}

    def find(self, number: int) -> Tool | None:
        """Give the valid data of a tool; None without. Number 0 has no length, no radius."""
        if number == 0:
            return Tool(valid=True)
        tool = self._tools.get(number)
        return tool if tool is not None and tool.valid else None

    def record(self, number: int) -> Tool:
        """Give the data of a tool for reading and writing, valid or not."""
        return self._tools.setdefault(number, Tool())

    def copy(self) -> "Tools":
        """Make a table that a program may write without changing this one."""
        return Tools({number: tool.copy() for number, tool in self._tools.items()})


def inch_tools(entries: Iterable[Entry]) -> set[int]:
    """Give the numbers of the tools whose lengths are in inches (P-TOOL-00008)."""
    return {e.indices[0] for e in entries if e.path == "wz[i].mass_einheit" and e.value}


def make_tools(entries: Iterable[Entry]) -> Tools:
    """Make the tools from the values of a list; the unit of a tool may be after its values."""
    entries = tuple(entries)
    inch = inch_tools(entries)
    tools = Tools()
    for entry in entries:
        number = entry.indices[0]
        factor = INCH_MM / UNITS_PER_INCH if number in inch else None
        _set(tools.record(number), entry, factor)
    return tools


def _set(tool: Tool, entry: Entry, inch_factor: float | None) -> None:
    number = float(entry.value)
    # One division, so that round values stay exact
    value_mm = number / UNITS_PER_MM if inch_factor is None else number * inch_factor
    match entry.path:
        case "wz[i].laenge":
            tool.length_mm = value_mm
        case "wz[i].radius":
            tool.radius_mm = value_mm
        case "wz[i].ax_versatz[j]":
            tool.offsets_mm[entry.indices[1]] = value_mm
        case "wz[i].tool_fixed":
            tool.fixed = bool(entry.value)
        case "wz[i].gueltig":
            tool.valid = bool(entry.value)
