"""Rig files: what is on the bench, as TOML, checked before anything is built.

A rig names segments, drives, axes with their parameter lists, plant FMUs and their wiring. A short
file may name another as its `base` and change single keys. Every mistake is a `UserError` that
names file, line and key.
"""

import re
import tomllib
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import (
    Discriminator,
    Field,
    PlainValidator,
    SerializeAsAny,
    StringConstraints,
    Tag,
    ValidationError,
    model_validator,
)
from pydantic_core import ErrorDetails

from axisrig.bench.plan.assignment import MAP_KEYS
from axisrig.bench.plan.composition import Mistakes
from axisrig.bench.plan.info import INFO_KEY
from axisrig.bench.rig.reading.families import (
    FAMILIES,
    drive_table,
    joined,
    read_drive,
    read_segment,
    segment_table,
)
from axisrig.bench.rig.reading.law import DistanceTable
from axisrig.bench.rig.reading.once import read_once
from axisrig.bench.rig.reading.places import locate
from axisrig.bench.rig.reading.plc_sensors import PlcSensorTable, VariableName
from axisrig.bench.rig.reading.plc_task import PlcTaskTable, TerminalTable, take_apart
from axisrig.bench.rig.reading.refusals import form_errors, reference_errors
from axisrig.bench.rig.reading.tables import (
    CycleTable,
    DriveKeys,
    Name,
    RealtimeTable,
    SegmentKeys,
    Table,
)
from axisrig.kernel.errors import UserError, near_files
from axisrig.kernel.parameters.start_up import DRIVE_TYPE, drive_type

StartValue = bool | int | float | str
InfoKey = Annotated[str, StringConstraints(pattern=INFO_KEY)]
InfoValue = str | int | float


class ChannelTable(Table):
    """`[channel]`: its lists in the manual's format: parameters, zero offsets, tools.

    cutting_licence: the option that 3D distance control needs is there. accept: parameters of its
    list that would act on the machine and do not act here, by number or path.
    """

    list: str
    zero_offsets: str | None = None
    tools: str | None = None
    cutting_licence: bool = True
    accept: Sequence[str] = ()


SIGNAL_KEYS = ("probe_1", "probe_2", "limit_negative", "limit_positive", "home_switch")
PLANT_KEYS = ("plant", *SIGNAL_KEYS, "encoder_2")
"""Keys of an axis that name a plant."""


class LanguageTable(Table):
    """`[language]`: pass_over: published words that count for nothing (`#TIMER`, `G25`)."""

    pass_over: Sequence[str] = ()


LOAD = "load"  # encoder_2: an ideal scale at the load


class AxisTable(Table):
    """`[axis.NAME]`: one axis of the channel; the tables are in the order of the axes.

    node: its address, where the family of its drive has one. probe_1 to home_switch: sensors wired
    to the inputs of the drive. encoder_2: "load", or the distance sensor that its second encoder
    is. outside: whether its drive is real, outside this process; not said = where its segment is
    real. sensor_age_limit_ms: how old the value of the sensor of distance control may be; not said
    = three of its periods. accept: parameters of its list that would act on the machine and do not
    act here, by number or path.
    """

    list: str
    segment: Name
    node: Annotated[int, Field(ge=1, le=127)] | None = None
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
    accept: Sequence[str] = ()

    @property
    def node_id(self) -> int:
        """Its address, where its family has one: `read_rig` has seen that it is there."""
        assert self.node is not None
        return self.node

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


# Each has the keys of its carrier or family
Segment = Annotated[SerializeAsAny[SegmentKeys], PlainValidator(read_segment)]
Drive = Annotated[SerializeAsAny[DriveKeys], PlainValidator(read_drive)]


class RigFile(Table):
    """A whole rig; see docs/rigs.md for every key.

    info: what is tested (device, serial, software): written to the results, acts on nothing.
    hardware: the axes may move without being asked for each time (`--yes` on the command line).
    assumed: what `axisrig rig from` took for granted and nobody has confirmed yet.
    plc: variables that show distance sensors; plc_task: the other keys of the table `[plc]`.
    """

    title: str
    info: Mapping[InfoKey, InfoValue] = Field(default_factory=dict)
    hardware: bool = False
    assumed: Sequence[str] = ()
    cycle: CycleTable = CycleTable()
    realtime: RealtimeTable = RealtimeTable()
    distance: DistanceTable = DistanceTable()
    channel: ChannelTable
    language: LanguageTable = LanguageTable()
    segment: dict[Name, Segment]
    drive: dict[Name, Drive]
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


def _toml_hint(line: str) -> str | None:
    """Say what a line that is no TOML was to be, where that can be seen."""
    key, sign, value = (part.strip() for part in line.partition("#")[0].partition("="))
    if not sign:
        return None
    if re.fullmatch(r"[+-]?\d+,\d+", value):
        return f"a decimal point, not a comma: {key} = {value.replace(',', '.')}"
    if re.match(r"[^\W\d]", value) and value not in ("true", "false"):
        text = value.strip('"').replace('"', "")
        return f'a text is in quotes: {key} = "{text}"'
    return None


def _read_toml(path: Path) -> dict[str, Any]:
    if not path.is_file():
        what = "a folder, not a rig file" if path.is_dir() else "rig file not found"
        hint = None if path.is_dir() else near_files(path.parent, path.name)
        raise UserError(what, file=path, hint=hint)
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
        hint = _toml_hint(text.splitlines()[line - 1]) if line else None
        raise UserError(
            f"no valid TOML: {message}", file=path, line=line, column=column, hint=hint
        ) from error
    except (ValueError, RecursionError) as error:  # numbers too long, brackets too deep
        raise UserError(
            "no valid TOML: a number too long or brackets too deep", file=path
        ) from error


LIST_KEYS = ("list", "zero_offsets", "tools")
"""Keys of channel and axes that name a file."""
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
        allowed = "a path in quotes, from this file"
        raise UserError("`base` is no rig file", file=path, value=base, allowed=allowed)
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


def _known_keys(keys: tuple[str, ...], table: dict[str, Any]) -> list[str]:
    """Return the keys that the part of a rig which holds the last of `keys` may have."""
    model: Any = RigFile
    named = {
        "axis": AxisTable, "plant": PlantTable, "cycle": CycleTable, "channel": ChannelTable,
        "realtime": RealtimeTable, "distance": DistanceTable, "plc": PlcSensorTable,
        "language": LanguageTable,
    }  # fmt: skip
    by_word = {"segment": segment_table, "drive": drive_table}
    if keys[2:3] == ("map",):
        model = MapTable
    elif keys[:2] == ("plc", "terminal"):
        model = TerminalTable
    elif keys[0] == "plc" and not keys[1].startswith("V.E."):
        model = PlcTaskTable
    elif len(keys) > 2 and keys[0] in by_word:
        model = by_word[keys[0]](table[keys[0]][keys[1]])
    elif len(keys) > 1:
        model = named.get(keys[0], RigFile)
    return [*model.model_fields, *(["base"] if model is RigFile else [])]


def _name_families(table: dict[str, Any]) -> None:
    """Give each drive without a family that of P-AXIS-00020 of a list of its axes.

    With one family there is nothing to choose. On a segment that does not carry it, and where a
    drive stands for others, it is the usual one. What is wrong with a list is reported where the
    lists are read.
    """
    if len({row.family for row in FAMILIES}) == 1 or not isinstance(table.get("drive"), dict):
        return
    for name, drive in table["drive"].items():
        if not isinstance(drive, dict) or "family" in drive or drive.get("as_canopen"):
            continue
        own = [
            axis
            for axis in _tables(table.get("axis"))
            if isinstance(axis, dict) and axis.get("drive") == name
        ]
        named = [
            family
            for axis in own
            if (family := _listed_family(axis.get("list")))
            and _carries(table, axis.get("segment"), family)
        ]
        if named:
            drive["family"] = named[0]


def _carries(table: dict[str, Any], segment: object, family: str) -> bool:
    """Whether a segment carries a family; one that is not there is reported elsewhere."""
    segments = table.get("segment")
    found = segments.get(segment) if isinstance(segments, dict) else None
    if not isinstance(found, dict):
        return True
    return joined(family, str(found.get("carrier", FAMILIES[0].carrier))) is not None


def _listed_family(path: object) -> str:
    """Return the family of the drive type that a list names; empty for none, and for no list."""
    try:
        parameters = read_once(str(path), "axis")
    except UserError:
        return ""
    return drive_type(parameters).family if parameters.origin(DRIVE_TYPE) else ""


def read_rig(path: Path) -> tuple[RigFile, list[Path]]:
    """Read and check a rig file with its bases; return it and its files, nearest first.

    Raises UserError with file, line and key for anything that is not a rig.
    """
    table, files = load_tables(path.resolve())
    _name_families(table)
    mistakes = Mistakes()
    top = [*RigFile.model_fields, "base"]
    for error in reference_errors(table, files, PLANT_KEYS, {"encoder_2": LOAD}, top):
        mistakes.add(error)
    try:
        rig = RigFile.model_validate(table)
    except ValidationError as error:
        known_keys = partial(_known_keys, table=table)
        for each in form_errors(error.errors(), files, _keys_of, known_keys):
            mistakes.add(each)
        mistakes.refuse(files[0])
        raise
    mistakes.refuse(files[0])
    _check_addresses(rig, files)
    return rig, files


def _keys_of(detail: ErrorDetails) -> tuple[str, ...]:
    """Return the keys that an error of the form is about."""
    # What follows a start value are the kinds that were tried
    depth = 6 if detail["loc"][2:3] == ("map",) else 4
    forms = (_TEXT, _TABLE, _NOTHING)
    keys = tuple(str(part) for part in detail["loc"][:depth] if part not in forms)
    return ("plc", *keys[1:]) if keys[0] == "plc_task" else keys


def _check_addresses(rig: RigFile, files: list[Path]) -> None:
    """Refuse an axis without the node that its carrier needs, and one that has none."""
    for name, axis in rig.axis.items():
        segment = rig.segment.get(axis.segment)
        if segment is None or (axis.node is not None) == segment.has_nodes:
            continue
        keys = ("axis", name, "node")
        if axis.node is None:
            raise rig_error(files, keys, f"the rig lacks the key {'.'.join(keys)}")
        message = f"axis {name}: on segment {axis.segment} ({segment.carrier}) there are no nodes"
        raise rig_error(files, keys, message, value=axis.node)


def rig_error(files: list[Path], keys: tuple[str, ...], message: str, **details: Any) -> UserError:
    """Make a UserError that points at a key of the rig (for checks after that of the form)."""
    file, line = locate(files, keys)
    return UserError(message, file=file, line=line, **details)


def error_at(
    files: list[Path], keys: tuple[str, ...], error: UserError, message: str | None = None
) -> UserError:
    """Give an error without a place that of the key of the rig whose value it is about."""
    found = {"value": error.value, "allowed": error.allowed, "hint": error.hint}
    return rig_error(files, keys, message or error.message, **found)
