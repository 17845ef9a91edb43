"""What the EDS or DCF of a drive says against its rig: warnings, since files may err."""

from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Final

from canopen.objectdictionary import ObjectDictionary

from axisrig.bench.rig.canopen.dcf_words import dcf_warnings
from axisrig.bench.rig.canopen.keys import DriveTable
from axisrig.bench.rig.canopen.members import can_axes, drive_of, segment_of
from axisrig.bench.rig.canopen.schedule import fixed_frames
from axisrig.bench.rig.canopen.startup import drive_dictionary
from axisrig.bench.rig.reading.file import AxisTable
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.drives.canopen.dictionary import eds_notes, variable
from axisrig.kernel.drives.canopen.eds_file import read_eds_file
from axisrig.kernel.drives.canopen.eds_text import COMMISSIONING_NAMES
from axisrig.kernel.drives.canopen.startup_steps import IDENTITY, PROFILE_MASK

PLACES_MAX: Final = 3
IDENTITY_OBJECT: Final = 0x1018
DEVICE_TYPE, SUPPORTED_MODES, INTERPOLATION, SYNC_PERIOD = 0x1000, 0x6502, 0x60C2, 0x1006
RATES: Final = (10_000, 20_000, 50_000, 125_000, 250_000, 500_000, 800_000, 1_000_000)
"""Bit rates of CiA 301, bit/s: an EDS says yes or no to each, and nothing of others."""


def eds_warnings(settings: Settings) -> list[str]:
    """Compare profile, modes, bit rate and node of each drive that has an EDS with the rig."""
    return [
        f"axis {name}, drive {settings.rig.axis[name].drive}: {text}"
        for name in can_axes(settings)
        for text in _of_axis(settings, name, settings.rig.axis[name])
    ]


def _of_axis(settings: Settings, name: str, axis: AxisTable) -> Iterator[str]:
    drive = drive_of(settings, name)
    if drive.eds is None:
        return
    od = drive_dictionary(drive, axis.node_id, drive.make())
    yield from _device(drive, od)
    yield from _unstoppable(settings, name)
    bitrate = segment_of(settings, axis.segment).bitrate
    rates = sorted(od.device_information.allowed_baudrates)
    if rates and bitrate in RATES and bitrate not in rates:
        known = ", ".join(_rate(rate) for rate in rates)
        yield (
            f"by its EDS it has no {_rate(bitrate)}, the bit rate of segment {axis.segment}"
            f" (it has {known})"
        )
    yield from _identity(drive, od)
    yield from _mends(drive.eds)
    yield from dcf_warnings(settings, name, od)
    node, dcf_rate = commissioned(drive.eds)
    is_other = node not in (None, axis.node) or dcf_rate not in (None, bitrate)
    if is_other:
        found = [f"node {node}"] if node is not None else []
        found += [_rate(dcf_rate)] if dcf_rate is not None else []
        yield (
            f"its DCF is for {' at '.join(found)}, the rig has node {axis.node} at {_rate(bitrate)}"
        )


def _identity(drive: DriveTable, od: ObjectDictionary) -> Iterator[str]:
    for name, value in drive.identity.items():
        found = variable(od, IDENTITY_OBJECT, IDENTITY[name])
        default = found.default if found is not None else None
        if default and default != value:  # 0: the file leaves it open
            yield (
                f"its EDS has the {name} 0x{default:X} (1018:{IDENTITY[name]}), the rig wants"
                f" 0x{value:X}: the start-up ends with 900021 where the drive says so too"
            )


def _mends(path: str) -> Iterator[str]:
    """Say what was mended in the file, places of one kind together."""
    places: dict[str, list[str]] = {}
    for note in eds_notes(path):
        where = f"line {note.line} {note.place}" if note.line is not None else note.place
        places.setdefault(note.text, []).append(where)
    for text, found in places.items():
        shown, more = [place for place in found if place][:PLACES_MAX], len(found) - PLACES_MAX
        where = f"{', '.join(shown)}{f' and {more} more' if more > 0 else ''}: " if shown else ""
        yield f"its EDS, {where}{text}"


def _device(drive: DriveTable, od: ObjectDictionary) -> Iterator[str]:
    profile = _default(od, DEVICE_TYPE) & PROFILE_MASK
    if profile and drive.device_type is not False and profile != drive.device_type:
        yield (
            f"its EDS is of profile {profile} (object 1000), the rig wants {drive.device_type}:"
            " the start-up ends with 900021 where the drive says so too"
        )
    modes = _default(od, SUPPORTED_MODES)
    # Bit n - 1 is mode n; those of the maker have no bit of their own. 0: the file leaves it open
    if modes and drive.mode > 0 and not modes >> drive.mode - 1 & 1:
        yield (
            f"by its EDS it has no mode {drive.mode} (csp is bit 7 of object 6502,"
            f" which is 0x{modes:X})"
        )
    if not any(variable(od, *place) for place in ((SYNC_PERIOD, 0), (INTERPOLATION, 1))):
        yield (
            "its EDS has neither 60C2 nor 1006: nothing gives it the period of the set positions;"
            " set it as the maker says"
        )


def _unstoppable(settings: Settings, name: str) -> Iterator[str]:
    """Name TPDOs that the drive sends although the mapping leaves them out."""
    for kind, frame in fixed_frames(settings, name):
        when = "with SYNC" if kind == "TPDO" else "by event"
        title = frame.name.removeprefix(f"{name}.").removesuffix(" (not mapped)")
        yield (
            f"{title} is on by its EDS, comes {when} and cannot be switched off: it takes bus time,"
            " which the sums below count, and the kernel does not read it"
        )


def _default(od: ObjectDictionary, index: int) -> int:
    found = variable(od, index, 0)
    value = None if found is None else found.default
    return value if isinstance(value, int) else 0


def _rate(rate: int) -> str:
    return f"{rate // 1000} kbit/s" if rate % 1000 == 0 else f"{rate} bit/s"


def commissioned(path: str) -> tuple[int | None, int | None]:
    """Return node number and bit rate (bit/s) that a DCF gives its device; None: not said.

    Raises UserError with the key for what is no number.
    """
    file = Path(path)
    return _commissioned(path, file.stat().st_mtime_ns)


@cache
def _commissioned(path: str, _state: int) -> tuple[int | None, int | None]:
    file = read_eds_file(path)
    found = [file.sections[name] for name in COMMISSIONING_NAMES if name in file.sections]
    if not found:
        return None, None
    node, rate = (file.number(found[0], key) or None for key in ("NodeID", "Baudrate"))
    return node, None if rate is None else rate * 1000
