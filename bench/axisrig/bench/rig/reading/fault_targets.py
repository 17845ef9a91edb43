"""What the column `target` of `faults.csv` means in a rig: the names that a plan writes."""

from collections.abc import Callable, Iterable, Mapping

from axisrig.bench.rig.reading.file import LOAD, RigFile

_PDOS = [f"{direction}PDO{number}" for direction in "TR" for number in (1, 2, 3, 4)]
AXIS_TELEGRAMS = (*_PDOS, "SDO", "EMCY", "HEARTBEAT")
"""What a drive and the kernel exchange; SDO is the answer of the drive."""
BUS_TELEGRAMS = ("SYNC", "NMT")
TERMINAL, TERMINAL_TELEGRAMS = "terminal", ("TPDO1", "SDO", "HEARTBEAT")
"""The node that is the terminal of the PLC, and what it sends."""
PLC = "plc"
"""The task of the PLC."""
INPUT = "input"
"""Word for an input of a plant, `probe.switched_on`: which ones there are its FMU knows."""


_OF_AXES = {"telegram", "axis", "slave", "idents", "image", "interface"}


def targets(words: Iterable[str], rig: RigFile) -> list[str]:
    """Return everything that the words of a column `target` stand for in a rig."""
    return [name for word, names in _NAMES.items() if word in words for name in names(rig)]


def is_target(name: str, words: Iterable[str], rig: RigFile) -> bool:
    """Whether the words of a column `target` stand for a name in a rig, as far as it knows."""
    plant, _, variable = name.partition(".")
    is_input = INPUT in words and plant in rig.plant and variable != ""
    return is_input or name in targets(words, rig)


def place_of(target: str, words: Iterable[str], rig: RigFile) -> tuple[str, str, str]:
    """Return axis, segment and telegram of a target; empty where it has none.

    words: of the column `target` of its kind.
    """
    place, _, telegram = target.partition(".")
    if place in rig.axis and _OF_AXES & set(words):
        return place, "", telegram
    if {"telegram", "bus", "line"} & set(words):
        return "", terminal_segment(rig) if place == TERMINAL else place, telegram
    return "", "", ""


def axes_of(target: str, words: Iterable[str], rig: RigFile) -> tuple[str, ...]:
    """Return the axes whose moments a fault of a target begins at; all where it belongs to none.

    words: of the column `target` of its kind.
    """
    axis, segment, _ = place_of(target, words, rig)
    if axis:
        return (axis,)
    if segment:
        found = [name for name, table in rig.axis.items() if table.segment == segment]
    else:
        plant = target.partition(".")[0] if INPUT in words else target
        wired = {n: (*a.signals.values(), a.encoder_2, a.plant) for n, a in rig.axis.items()}
        found = [name for name, plants in wired.items() if plant in plants]
    return tuple(found or rig.axis)


def terminal_segment(rig: RigFile) -> str:
    """Return the segment of the node that is the terminal of the PLC; empty where it is none."""
    table = None if rig.plc_task is None else rig.plc_task.terminal
    return table.segment or "" if table is not None and table.is_on_can else ""


def _telegrams(rig: RigFile) -> list[str]:
    names = [f"{axis}.{telegram}" for axis in rig.axis for telegram in AXIS_TELEGRAMS]
    names += [f"{bus}.{telegram}" for bus in rig.segment for telegram in BUS_TELEGRAMS]
    if terminal_segment(rig):
        names += [f"{TERMINAL}.{telegram}" for telegram in TERMINAL_TELEGRAMS]
    return names


def _signals(rig: RigFile) -> list[str]:
    """Return probes and switches that are wired to a drive or to the terminal of the PLC."""
    wired = [name for axis in rig.axis.values() for name in axis.signals.values()]
    terminal = None if rig.plc_task is None else rig.plc_task.terminal
    return list(dict.fromkeys([*wired, *(terminal.inputs.values() if terminal else ())]))


def _sensors(rig: RigFile) -> list[str]:
    """Return distance sensors that a drive or the PLC reads."""
    seconds = [axis.encoder_2 for axis in rig.axis.values() if axis.encoder_2 not in (None, LOAD)]
    return list(dict.fromkeys([*map(str, seconds), *(table.sensor for table in rig.plc.values())]))


def _clocks(rig: RigFile) -> list[str]:
    """Return the terminal of the PLC where it has a clock of its own."""
    terminal = None if rig.plc_task is None else rig.plc_task.terminal
    return [TERMINAL] if terminal is not None and terminal.segment is None else []


def _is_on_line(axis: str, rig: RigFile) -> bool:
    segment = rig.segment.get(rig.axis[axis].segment)
    return segment is not None and segment.is_line


def _swaps_images(axis: str, rig: RigFile) -> bool:
    segment = rig.segment.get(rig.axis[axis].segment)
    return segment is not None and segment.swaps_images


def _has_interface(drive: str, rig: RigFile) -> bool:
    table = rig.drive.get(drive)
    return table is not None and table.has_interface


def _has_idents(drive: str, rig: RigFile) -> bool:
    table = rig.drive.get(drive)
    return table is not None and table.has_idents


_NAMES: Mapping[str, Callable[[RigFile], Iterable[str]]] = {
    "telegram": _telegrams,
    "bus": lambda rig: rig.segment,
    "axis": lambda rig: rig.axis,
    "line": lambda rig: [name for name, table in rig.segment.items() if table.is_line],
    "slave": lambda rig: [name for name in rig.axis if _is_on_line(name, rig)],
    "idents": lambda rig: [name for name, axis in rig.axis.items() if _has_idents(axis.drive, rig)],
    "image": lambda rig: [name for name in rig.axis if _swaps_images(name, rig)],
    "interface": lambda rig: [n for n, axis in rig.axis.items() if _has_interface(axis.drive, rig)],
    "signal": _signals,
    "sensor": _sensors,
    "plc": lambda rig: [] if rig.plc_task is None else [PLC],
    "terminal": _clocks,
    INPUT: lambda rig: [f"{plant}.INPUT" for plant in rig.plant],
}
