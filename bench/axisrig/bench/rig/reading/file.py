"""Rig files: what is on the bench, as TOML, checked before anything is built.

A rig names segments, drives, axes with their parameter lists, plant FMUs and their wiring. A short
file may name another as its `base` and change single keys. Every mistake is a `UserError` that
names file, line and key.
"""

import difflib
import re
import tomllib
from collections.abc import Callable
from functools import cached_property
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import (
    AfterValidator,
    BeforeValidator,
    Discriminator,
    Field,
    PrivateAttr,
    Tag,
    ValidationError,
    create_model,
    model_validator,
)

from axisrig.bench.bus.can.hardware import SIMULATED, Option, interface_names, parse_options
from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.bench.drive.cia402.dictionary.profiles import (
    DEFAULT_PROFILE,
    Habit,
    habits,
    in_lengths,
    make_profile,
    profile_keys,
    profile_names,
)
from axisrig.bench.rig.reading.law import DistanceTable
from axisrig.bench.rig.reading.plc_sensors import PlcSensorTable, VariableName
from axisrig.bench.rig.reading.plc_task import PlcTaskTable, TerminalTable, take_apart
from axisrig.bench.rig.reading.startup import StartUpKeys
from axisrig.bench.rig.reading.tables import CycleTable, Name, RealtimeTable, Table, in_words
from axisrig.kernel.errors import UserError, nearest

StartValue = bool | int | float | str


def _whole_um(value_mm: float) -> float:
    if round(value_mm * 1000) != round(value_mm * 1000, 6):
        raise ValueError("a whole number of micrometres is needed")
    return value_mm


class ChannelTable(Table):
    """`[channel]`: its lists in the manual's format: parameters, zero offsets, tools.

    cutting_licence: the option that 3D distance control needs is there.
    """

    list: str
    zero_offsets: str | None = None
    tools: str | None = None
    cutting_licence: bool = True


def _known_interface(name: str) -> str:
    names = interface_names()
    if name not in names:
        near = nearest(name, names) or names
        raise ValueError(f"there is no such CAN interface; allowed: {', '.join(near)}")
    return name


def _options(value: object) -> object:
    return parse_options(value) if isinstance(value, str) else value


class SegmentTable(Table):
    """`[segment.NAME]`: one CAN bus.

    interface: simulated, or the python-can interface of a real one; channel and options: for it.
    queue, drive_queue: transmit queue of the kernel's port and of the drives' ports. bus_off: what
    a controller does that has become bus-off. overload: what becomes of a cycle that does not fit.
    """

    interface: Annotated[str, AfterValidator(_known_interface)] = SIMULATED
    channel: str | int | None = None
    options: Annotated[dict[str, Option], BeforeValidator(_options)] = Field(default_factory=dict)
    bitrate: Literal[125_000, 250_000, 500_000, 800_000, 1_000_000] = 1_000_000
    queue: Literal["fifo", "mailbox"] = "fifo"
    drive_queue: Literal["fifo", "mailbox"] = "fifo"
    bus_off: Literal["recover", "stay"] = "recover"
    overload: Literal["refuse", "run"] = "refuse"


def _habit_field(habit: Habit) -> Any:
    kind: Any = {"whole": int, "number": float, "flag": bool, "text": str}.get(habit.type)
    if kind is None:
        kind = Literal[habit.words]
    elif habit.low is not None:
        kind = Annotated[kind, Field(ge=kind(habit.low), le=kind(habit.high))]
    if habit.field.endswith("_um"):
        kind = Annotated[kind, AfterValidator(_whole_um)]
    return kind, habit.values[DEFAULT_PROFILE]


_FIELDS: dict[str, Any] = {
    "profile": (Literal[profile_names()], DEFAULT_PROFILE),
    **{key: _habit_field(habit) for key, habit in habits().items()},
}
_HabitTable: Any = create_model("_HabitTable", __base__=StartUpKeys, **_FIELDS)


class DriveTable(_HabitTable):  # type: ignore[misc]
    """`[drive.NAME]`: what kind of drive moves an axis.

    profile: name of a set of habits; every key of `drive/profiles.csv` that the rig does not
    give has the profile's value. position_unit_um: length of a position unit on the bus, for drives
    whose unit is a length; not said = an encoder increment. as_canopen: it replaces the drive of
    another type that a list names (P-AXIS-00020). How it is started: `StartUpKeys`.
    """

    position_unit_um: Annotated[float, Field(gt=0, le=1e6)] | None = None
    as_canopen: bool = False
    _given: dict[str, Any] = PrivateAttr(default_factory=dict)

    @model_validator(mode="wrap")
    @classmethod
    def _with_profile(cls, values: Any, handler: Callable[[Any], "DriveTable"]) -> "DriveTable":
        name = values.get("profile", DEFAULT_PROFILE) if isinstance(values, dict) else None
        if not isinstance(name, str) or name not in profile_names():
            return handler(values)
        table = handler({**profile_keys(name), **values})
        table._given = dict(values)
        return table

    def changed(self, key: str, value: Any) -> "DriveTable":
        """Return the drive with one key changed; a new profile keeps what the rig has given.

        Raises ValidationError.
        """
        table: DriveTable = DriveTable.model_validate({**self._given, key: value})
        return table

    def make(self) -> DriveProfile:
        """Make the drive node's profile. Raises UserError for a value that cannot be."""
        return self._made

    @cached_property  # asked for some thirty times at every start
    def _made(self) -> DriveProfile:
        made = make_profile({key: getattr(self, key) for key in habits()})
        return made if self.position_unit_um is None else in_lengths(made, self.position_unit_um)


SIGNAL_KEYS = ("probe_1", "probe_2", "limit_negative", "limit_positive", "home_switch")
LOAD = "load"  # encoder_2: an ideal scale at the load


class AxisTable(Table):
    """`[axis.NAME]`: one axis of the channel; the tables are in the order of the axes.

    probe_1 to home_switch: sensors wired to the inputs of the drive. encoder_2: "load", or the
    distance sensor that its second encoder is. outside: whether its drive is real, outside this
    process; not said = where its segment is real. sensor_age_limit_ms: how old the value of the
    sensor of distance control may be; not said = three of its periods.
    """

    list: str
    segment: Name
    node: Annotated[int, Field(ge=1, le=127)]
    drive: Name
    plant: Name
    probe_1: Name | None = None
    probe_2: Name | None = None
    limit_negative: Name | None = None
    limit_positive: Name | None = None
    home_switch: Name | None = None
    encoder_2: Name | None = None
    outside: bool | None = None
    sensor_age_limit_ms: Annotated[float, Field(gt=0, le=600_000)] | None = None

    @property
    def signals(self) -> dict[str, str]:
        """The sensors that are wired to inputs of the drive, by key."""
        named = {key: getattr(self, key) for key in SIGNAL_KEYS}
        return {key: name for key, name in named.items() if name is not None}


class MapTable(Table):
    """`[plant.NAME.map]`: `role = { variable = "x", unit = "mm" }`.

    unit: where the FMU gives none. sign: -1 turns direction or level round. threshold: a number
    above it is the level true. lead_mm: travel per revolution, for a rotation.
    """

    variable: str
    unit: str | None = None
    sign: Literal[1, -1] = 1
    threshold: float | None = None
    lead_mm: Annotated[float, Field(gt=0)] | None = None


_TEXT, _TABLE, _NOTHING = "(text)", "(table)", "(false)"


def _form(entry: object) -> str:
    """Return which form an entry of a map has; what is none of them is held to be a text."""
    if entry is False:
        return _NOTHING
    return _TABLE if isinstance(entry, dict | MapTable) else _TEXT


MapEntry = Annotated[
    Annotated[str, Tag(_TEXT)]
    | Annotated[MapTable, Tag(_TABLE)]
    | Annotated[Literal[False], Tag(_NOTHING)],
    Discriminator(_form),
]


MODEL_SUFFIX = ".mo"
"""Of the file of a Modelica model; it has the name of the model."""


class PlantTable(Table):
    """`[plant.NAME]`: an FMU, its start values (`surface_mm = 100`) and what it is wired to.

    fmu: name of a model of the library, or path of an .fmu or of a Modelica model (.mo), relative
    to the rig file. kind: what it is, where its variables leave that open. map: role -> variable;
    false leaves a role out.
    shares: the axis plant whose instance of this FMU this one is a further axis of; suffix: ends
    the names of the variables of one axis of several (`_1`). stroke_mm: how far a probe may be
    deflected; breaks: past it the probe breaks, which ends the program.
    """

    fmu: str
    kind: Literal["axis", "probe", "distance"] | None = None
    shares: Name | None = None
    suffix: str = ""
    start: dict[str, StartValue] = Field(default_factory=dict)
    wire: dict[Name, Name] = Field(default_factory=dict)
    map: dict[Name, MapEntry] = Field(default_factory=dict)
    stroke_mm: Annotated[float, Field(gt=0, le=1000)] | None = None
    breaks: bool = False


class RigFile(Table):
    """A whole rig; see docs/rigs.md for every key.

    hardware: the axes may move without being asked for each time (`--yes` on the command line).
    plc: variables that show distance sensors; plc_task: the other keys of the table `[plc]`.
    """

    title: str
    hardware: bool = False
    cycle: CycleTable = CycleTable()
    realtime: RealtimeTable = RealtimeTable()
    distance: DistanceTable = DistanceTable()
    channel: ChannelTable
    segment: dict[Name, SegmentTable]
    drive: dict[Name, DriveTable]
    axis: dict[Name, AxisTable]
    plant: dict[Name, PlantTable]
    plc: dict[VariableName, PlcSensorTable] = Field(default_factory=dict)
    plc_task: PlcTaskTable | None = None

    @model_validator(mode="before")
    @classmethod
    def _take_task_apart(cls, values: Any) -> Any:
        """Give the keys of `[plc]` that are no variables to the task of the PLC."""
        return take_apart(values)


def _merge(below: dict[str, Any], above: dict[str, Any]) -> dict[str, Any]:
    merged = dict(below)
    for key, value in above.items():
        old = merged.get(key)
        # An entry of a map is one value: the sign of one variable is not that of another
        is_whole = isinstance(value, dict) and "variable" in value
        if isinstance(value, dict) and isinstance(old, dict) and not is_whole:
            value = _merge(old, value)  # noqa: PLW2901
        merged[key] = value
    return merged


def _read_toml(path: Path) -> dict[str, Any]:
    if not path.is_file():
        what = "a folder, not a rig file" if path.is_dir() else "rig file not found"
        raise UserError(what, file=path)
    try:
        text = path.read_text(encoding="utf-8-sig")
    except OSError as error:
        raise UserError(f"the rig file cannot be read: {error.strerror}", file=path) from error
    except UnicodeDecodeError as error:
        raise UserError(
            "the rig file is not UTF-8 text", file=path, value=f"byte {error.start}"
        ) from error
    if not text.strip():
        raise UserError("the rig file is empty", file=path, hint="see docs/rigs.md")
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        place = re.search(r"\(at line (\d+), column (\d+)\)", str(error))
        line, column = (int(place[1]), int(place[2])) if place else (None, None)
        message = re.sub(r" \(at .*\)", "", str(error))
        raise UserError(f"no valid TOML: {message}", file=path, line=line, column=column) from error
    except (ValueError, RecursionError) as error:  # numbers too long, brackets too deep
        raise UserError(
            "no valid TOML: a number too long or brackets too deep", file=path
        ) from error


LIST_KEYS, MAP_KEYS = ("list", "zero_offsets", "tools"), ("eds", "pdo_map")
"""Keys of channel and axes, and of drives, that name a file."""
PROGRAM_KEYS = ("program",)
"""Of the PLC."""


def load_tables(path: Path, above: tuple[Path, ...] = ()) -> tuple[dict[str, Any], list[Path]]:
    """Return the merged tables and the files they came from, nearest first.

    Paths of lists and FMUs are made absolute, relative to the file that names them.
    """
    if path in above:
        raise UserError("rig files name each other as base in a circle", file=path)
    table = _read_toml(path)
    _anchor_paths(table, path.parent)
    base = table.pop("base", None)
    if base is None:
        return table, [path]
    if not isinstance(base, str):
        raise UserError("`base` must be the path of a rig file", file=path, value=base)
    below, files = load_tables((path.parent / base).resolve(), (*above, path))
    return _merge(below, table), [path, *files]


def _anchor_paths(table: dict[str, Any], folder: Path) -> None:
    lists = [table.get("channel"), *_tables(table.get("axis"))]
    _anchor(folder, lists, LIST_KEYS)
    _anchor(folder, _tables(table.get("drive")), MAP_KEYS)
    _anchor(folder, [table.get("plc")], PROGRAM_KEYS)
    for entry in _tables(table.get("plant")):
        if isinstance(entry, dict) and str(entry.get("fmu", "")).endswith((".fmu", MODEL_SUFFIX)):
            entry["fmu"] = str((folder / entry["fmu"]).resolve())


def _anchor(folder: Path, entries: list[Any], keys: tuple[str, ...]) -> None:
    for entry in entries:
        for key in keys:
            if isinstance(entry, dict) and isinstance(entry.get(key), str):
                entry[key] = str((folder / entry[key]).resolve())


def _tables(value: Any) -> list[Any]:
    return list(value.values()) if isinstance(value, dict) else []


def _locate(files: list[Path], keys: tuple[str, ...]) -> tuple[Path, int | None]:
    """Find file and line of a key path: its own line, else the header of its table."""
    for depth in range(len(keys), 0, -1):
        table, key = ".".join(keys[: depth - 1]), keys[depth - 1]
        for file in files:
            line = _find_key(file.read_text(encoding="utf-8-sig"), table, key)
            if line is not None:
                return file, line
    return files[0], None


def _find_key(text: str, table: str, key: str) -> int | None:
    current = ""
    wanted = f"{table}.{key}" if table else key
    for number, line in enumerate(text.splitlines(), 1):
        header = re.match(r"\s*\[([^\[\]]+)\]", line)
        if header:
            current = re.sub(r"[\s\"']", "", header[1])
            if current == wanted or current.startswith(f"{wanted}."):
                return number
        elif current == table and re.match(rf"\s*[\"']?{re.escape(key)}[\"']?\s*[.=]", line):
            return number
    return None


def _known_keys(keys: tuple[str, ...]) -> list[str]:
    """Return the keys that the table which holds the last of `keys` may have."""
    model: Any = RigFile
    named = {
        "segment": SegmentTable, "drive": DriveTable, "axis": AxisTable, "plant": PlantTable,
        "cycle": CycleTable, "channel": ChannelTable, "realtime": RealtimeTable,
        "distance": DistanceTable, "plc": PlcSensorTable,
    }  # fmt: skip
    if keys[2:3] == ("map",):
        model = MapTable
    elif keys[:2] == ("plc", "terminal"):
        model = TerminalTable
    elif keys[0] == "plc" and not keys[1].startswith("V.E."):
        model = PlcTaskTable
    elif len(keys) > 1:
        model = named.get(keys[0], RigFile)
    return [*model.model_fields, *(["base"] if model is RigFile else [])]


def read_rig(path: Path) -> tuple[RigFile, list[Path]]:
    """Read and check a rig file with its bases; return it and its files, nearest first.

    Raises UserError with file, line and key for anything that is not a rig.
    """
    table, files = load_tables(path.resolve())
    try:
        return RigFile.model_validate(table), files
    except ValidationError as error:
        # A misspelt key is also a missing one; the spelling is what helps
        first = min(error.errors(), key=lambda e: e["type"] != "extra_forbidden")
        # What follows a start value are the kinds that were tried
        depth = 6 if first["loc"][2:3] == ("map",) else 4
        forms = (_TEXT, _TABLE, _NOTHING)
        keys = tuple(str(part) for part in first["loc"][:depth] if part not in forms)
        if keys[0] == "plc_task":
            keys = ("plc", *keys[1:])
        file, line = _locate(files, keys)
        place = ".".join(keys)
        if first["type"] == "extra_forbidden":
            known = _known_keys(keys)
            near = difflib.get_close_matches(keys[-1], known, n=1)
            raise UserError(
                f"unknown rig key {place}",
                file=file,
                line=line,
                allowed=known,
                hint=f"did you mean {near[0]}?" if near else None,
            ) from error
        if first["type"] == "missing":
            raise UserError(f"the rig lacks the key {place}", file=file, line=line) from error
        raise UserError(
            f"{place}: {in_words(first['type'], first['msg'])}",
            file=file,
            line=line,
            value=first.get("input"),
        ) from error


def rig_error(files: list[Path], keys: tuple[str, ...], message: str, **details: Any) -> UserError:
    """Make a UserError that points at a key of the rig (for checks after that of the form)."""
    file, line = _locate(files, keys)
    return UserError(message, file=file, line=line, **details)
