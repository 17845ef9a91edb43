"""The parameter lists of a rig: read, corrected as the control does, and what in them is inert."""

from collections.abc import Mapping, Sequence
from math import inf
from pathlib import Path

from axisrig.bench.plan.composition import Mistakes
from axisrig.bench.rig.reading.file import RigFile, rig_error
from axisrig.bench.rig.reading.once import read_once
from axisrig.kernel.errors import Alarm, near_files
from axisrig.kernel.measuring.fixed_stop.settings import FixedStopSettings
from axisrig.kernel.measuring.rules import FIXED_STOP
from axisrig.kernel.nc.coordinates.lists import TOOLS, ZERO_OFFSETS, Entry
from axisrig.kernel.nc.coordinates.tables import Lists
from axisrig.kernel.parameters import ParameterSet, start_up, written
from axisrig.kernel.parameters.drive_types import DRIVE_TYPES, SIMULATED
from axisrig.kernel.parameters.influence import group_of
from axisrig.kernel.parameters.lists import NEXT_AXIS
from axisrig.kernel.parameters.relations import noted
from axisrig.kernel.parameters.start_up import DRIVE_TYPE, drive_type, equal_schedule
from axisrig.kernel.parameters.table import table
from axisrig.kernel.time.clock import US, ns_to_seconds

# Keys of `[channel]` and targets of `set:` columns -> the lists they name
OFFSET_LISTS = {"zero_offsets": ZERO_OFFSETS, "tools": TOOLS}

DRIVE_INPUTS = (1, 2)

CRITERIA = "a lag limit (P-AXIS-00774 pos_lag_limit) or a window (P-AXIS-00778) with its time"
TIME = "min_time (P-AXIS-00775)"


def read_lists(rig: RigFile, files: list[Path]) -> tuple[ParameterSet, dict[str, ParameterSet]]:
    """Read the lists of the channel and of all axes; axes may share one list.

    Raises UserError for a list that is no file and for what is not accepted in one.
    """
    lists: list[tuple[tuple[str, ...], str]] = [(("channel", "list"), rig.channel.list)]
    lists += [(("axis", name, "list"), axis.list) for name, axis in rig.axis.items()]
    mistakes = Mistakes()
    for keys, path in lists:
        if not Path(path).is_file():
            message = f"the parameter list {Path(path).name} is no file"
            hint = near_files(Path(), path)
            mistakes.add(rig_error(files, keys, message, value=path, hint=hint))
    mistakes.refuse(files[0])
    axes = {}
    for name, axis in rig.axis.items():
        with mistakes.kept():
            axes[name] = read_once(axis.list, "axis", name)
    with mistakes.kept():
        channel = read_once(rig.channel.list, "channel")
    mistakes.refuse(files[0])
    return channel, axes


def read_offsets(rig: RigFile, files: list[Path]) -> Lists:
    """Read the lists of zero offsets and tools, as far as the rig names them.

    Raises UserError for a list that is no file and for what is not accepted in one.
    """
    lists = Lists()
    for key, name in OFFSET_LISTS.items():
        path = getattr(rig.channel, key)
        if path is None:
            continue
        if not Path(path).is_file():
            message = f"the list of {name} {Path(path).name} is no file"
            hint = near_files(Path(), path)
            raise rig_error(files, ("channel", key), message, value=path, hint=hint)
        lists.read(name, path)
    return lists


def jump_mm(parameters: ParameterSet, factor: float, period_us: int) -> float:
    """Return the largest credible way from one SYNC to the next: factor x P-AXIS-00212 x T.

    factor: `jump_factor` of the drive; 0: any way is credible.
    """
    fastest_mm_s = parameters.mm_s("getriebe[0].dynamik.vb_max")
    return factor * fastest_mm_s * ns_to_seconds(period_us * US) or inf


def acceleration_mm_s2(parameters: ParameterSet) -> float:
    """Return the largest acceleration that an axis can have: P-AXIS-00008 or P-AXIS-00003."""
    return max(parameters.mm_s2(f"getriebe[0].dynamik.{key}") for key in ("a_max", "a_emergency"))


def drive_input(parameters: ParameterSet) -> int:
    """Return the probing input of the drive; 1 where the list names external hardware."""
    number = parameters.integer("kenngr.measure.input")
    return number if number in DRIVE_INPUTS else 1


def take_over(channel: ParameterSet, axes: dict[str, ParameterSet]) -> list[Alarm]:
    """Correct what the control corrects at its start and return the warnings.

    Raises UserError for a combination of settings that cannot be.
    """
    warnings = start_up(channel, "")
    for name, parameters in axes.items():
        warnings += start_up(parameters, name)
    return warnings + equal_schedule(axes)


def check_numbers(axes: dict[str, ParameterSet]) -> None:
    """Refuse a logical number (P-AXIS-00016) that two lists give; without one nothing is said."""
    seen: dict[int, str] = {}
    for name, parameters in axes.items():
        place = parameters.origin(NEXT_AXIS)
        if place is None:
            continue
        number = parameters.integer(NEXT_AXIS)
        if number in seen:
            raise place.error(
                f"axes {seen[number]} and {name} have the same logical number (P-AXIS-00016)",
                value=number,
            )
        seen[number] = name


def substituted(rig: RigFile, axes: Mapping[str, ParameterSet]) -> dict[str, str]:
    """Return the axes whose lists name another drive than they have (P-AXIS-00020), with its type.

    Said in the lists or not: a list that names none means a CANopen drive.
    """
    types = {name: drive_type(axes[name]) for name in rig.axis if name in axes}
    return {
        name: f"{t.name} ({t.number})"
        for name, t in types.items()
        if t.family != rig.drive[rig.axis[name].drive].family_name
        and axes[name].origin(DRIVE_TYPE) is not None
    }


def substituted_in_words(rig: RigFile, axes: Mapping[str, ParameterSet]) -> str:
    """Say which axes run on a drive of CiA 402 though their lists name another type."""
    return ", ".join(f"{name}: {word}" for name, word in substituted(rig, axes).items())


def check_drive_types(rig: RigFile, axes: Mapping[str, ParameterSet]) -> None:
    """Refuse a drive type that nothing simulates, and one of another family than its drive.

    A drive that may stand for any type (`as_canopen`) is neither.
    Raises UserError with file and line of the setting.
    """
    for name, axis in rig.axis.items():  # of all lists, where a rig runs with some axes only
        key, parameters = axis.drive, axes[name]
        kind, place = drive_type(parameters), parameters.origin(DRIVE_TYPE)
        drive = rig.drive[key]
        if kind.family == drive.family_name or drive.replaces_others or place is None:
            continue
        word, value = f"{kind.name} ({kind.number})", parameters.get(DRIVE_TYPE)
        if kind.family:
            raise place.error(
                f"axis {name} has a drive of the type {word} (P-AXIS-00020) and drive {key} of the"
                f" rig is of the family {drive.family_name}",
                value=value,
                hint=f'family = "{kind.family}" in [drive.{key}] where its segment carries it,'
                " another P-AXIS-00020, or --as-canopen of run, nc and check",
            )
        known = " and ".join(row.name for row in DRIVE_TYPES.values() if row.family)
        raise place.error(
            f"axis {name} has a drive of the type {word} (P-AXIS-00020): only {known} drives run"
            f" here; {kind.why}",
            value=value,
            allowed=f"{', '.join(map(str, SIMULATED))}, or not said",
            hint="--as-canopen of run, nc and check runs it all the same on the drive of CiA 402"
            " that its segment carries, on CAN or EtherCAT, as does as_canopen = true of its"
            " [drive.D]; the results show it",
        )


def relation_notes(axes: Mapping[str, ParameterSet]) -> list[str]:
    """Say which settings go past a limit that is another parameter and stay as they are."""
    return [f"axis {name}: {words}" for name in axes for words in noted(axes[name])]


def inert_notes(rig: RigFile, channel: ParameterSet, axes: dict[str, ParameterSet]) -> list[str]:
    """Say for each list which of its settings do not act yet."""
    notes = []
    for of, path, parameters in (
        ("channel", rig.channel.list, channel),
        *((f"axis {name}", rig.axis[name].list, axes[name]) for name in axes),
    ):
        inert = [
            (key, value) for key, value in parameters.inert() if not _has_class(parameters, key)
        ]
        if inert:
            names = ", ".join(f"{name} = {written(value)}" for name, value in inert)
            what = "1 setting does" if len(inert) == 1 else f"{len(inert)} settings do"
            notes.append(f"{of}: {what} not act yet ({Path(path).name}): {names}")
        for name, by in parameters.unasked():
            notes.append(
                f"{of}: {_numbered(parameters, name)} does not act:"
                f" {_numbered(parameters, by)} is asked first and its default is"
                f" {written(parameters.get(by))}"
            )
    return notes


def _has_class(parameters: ParameterSet, key: str) -> bool:
    """Whether `influence.csv` says what a setting would change (`influence_notes`)."""
    path = table(parameters.kind).find(key)[0].path
    return group_of(parameters.kind, path) is not None


def _numbered(parameters: ParameterSet, path: str) -> str:
    number = parameters.resolve(path).parameter.number
    return f"{path} ({number})" if number else path


def stop_notes(axes: dict[str, ParameterSet]) -> list[str]:
    """Say which axes with the source FIXED_STOP (P-AXIS-00516) can find no stop as listed.

    Not an error: `#MEAS [AX= SIGNAL=]` may choose another source, and the axis may be at rest.
    """
    notes = []
    for name, parameters in axes.items():
        if parameters.word("kenngr.measure.signal") != FIXED_STOP:
            continue
        found = FixedStopSettings.read(parameters)
        if found.lag_limit_mm is not None:
            continue
        if found.window_mm is None:
            notes.append(f"axis {name}: as listed no stop can be found: set {CRITERIA}")
        elif not (found.min_time_ns or found.min_cycles):
            window = f"its window of {found.window_mm:g} mm has no minimum time"
            notes.append(f"axis {name}: as listed no stop can be found, {window}: set {TIME}")
    return notes


def offset_notes(lists: Lists, axes: Sequence[str] | None = None) -> list[str]:
    """Say what in the lists of zero offsets and tools cannot be meant, value by value.

    axes: those of the rig, in its order, which the indices count from 0; None without a rig.
    """
    notes: list[str] = []
    numbers: set[tuple[int, ...]] = set()
    for name, entries in lists.entries.items():
        last = {(entry.path, entry.indices): entry for entry in entries}
        valid = {at for (path, at), entry in last.items() if "gueltig" in path and entry.value}
        for entry in last.values():
            why = _oddity(entry, axes)
            if why is None and name == TOOLS and entry.indices[:1] not in valid | numbers:
                numbers.add(entry.indices[:1])
                number = entry.indices[0]
                why = f"the list has no `wz[{number}].gueltig 1`, so D{number} is refused"
            if why is not None:
                notes.append(f"{name}: {entry.written} ({entry.origin.short}): {why}")
    return notes


def _oddity(entry: Entry, axes: Sequence[str] | None) -> str | None:
    of_axis = entry.path.endswith(("versch", "inaktiv", "ax_versatz[j]"))
    if axes is not None and of_axis and entry.indices[1] >= len(axes):
        known = ", ".join(f"{at} = {axis}" for at, axis in enumerate(axes))
        return f"the rig has no axis {entry.indices[1]}, it has {known}"
    if entry.path == "wz[i].radius" and float(entry.value) < 0:
        return "a radius below 0"
    if entry.path.startswith("wz") and entry.indices[0] == 0:
        return "D0 is no tool, its data never act"
    return None
