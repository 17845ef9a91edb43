"""Which plants of a rig become one FMU, and the Modelica model that joins them.

A sensor reads the motion of each communication step, which no foreign master can give. So a sensor
and the axes that it is wired to are one model; an axis without sensors is the FMU of the library.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from fmpy import read_model_description
from fmpy.model_description import ModelDescription, ModelVariable

from axisrig.bench.machine.fmu_files import library_fmu, own_fmu
from axisrig.bench.rig.reading.file import MODEL_SUFFIX, MapTable, PlantTable
from axisrig.bench.rig.real_axes import simulated_plants
from axisrig.bench.rig.settings import Settings
from axisrig.fmus import MODELS
from axisrig.kernel.errors import UserError

_ROTARY = "AxisRig.Drives.RotaryAxis"
# rumoca 0.10.2 does not find the level at the start of a touch probe on an axis without states
_KINEMATIC = "AxisRig.Drives.KinematicAxis"
_TOUCH_PROBES = ("AxisRig.Sensors.TouchProbe", "AxisRig.Sensors.WorkpieceProbe")
_MOTION = ("start", "end", "rate_start", "rate_end")
_STEP = ("step_time", "step_size")
# Outputs of a sensor whose change ends a step early, where the importer allows it
_LEVELS = ("signal", "touching")
_TYPES: Mapping[str, str] = {
    "Float64": "Real",
    "Real": "Real",
    "Int32": "Integer",
    "Integer": "Integer",
    "Boolean": "Boolean",
}


@dataclass(frozen=True)
class Port:
    """An input or output of a part. name: in its FMU. plant, variable: whose it is."""

    name: str
    plant: str
    variable: ModelVariable

    @property
    def type(self) -> str:
        """Real, Integer or Boolean."""
        return _TYPES[self.variable.type]


@dataclass(frozen=True)
class Part:
    """An FMU of the package.

    name: of the component. plants: of the rig that are in it, axes first. model: of the library, or
    the file of an own one; None for one that joins several. ports: inputs and outputs. text: of the
    joining model. own: files of own models that it joins.
    """

    name: str
    plants: tuple[str, ...]
    model: str | None
    ports: tuple[Port, ...]
    text: str = ""
    own: tuple[Path, ...] = ()

    def parameter(self, plant: str, variable: str) -> str:
        """The name of a plant's parameter in the FMU."""
        return variable if self.model else f"{plant}.{variable}"


@dataclass
class _Group:
    axes: list[str] = field(default_factory=list)
    sensors: list[str] = field(default_factory=list)


def parts_of(settings: Settings) -> list[Part]:
    """The FMUs that a rig becomes, in the order of its plants.

    Raises UserError that lists everything in the rig that cannot be exported.
    """
    plants = {n: t for n, t in simulated_plants(settings).items() if t.shares is None}
    _refuse(settings, plants)
    descriptions = {name: _described(table) for name, table in plants.items()}
    return [_part(settings, group, descriptions) for group in _groups(settings, plants)]


def _described(table: PlantTable) -> ModelDescription:
    made = own_fmu(Path(table.fmu)) if _is_own(table) else library_fmu(table.fmu)
    return read_model_description(str(made), validate=False)


def _is_own(table: PlantTable) -> bool:
    """Whether a plant is a Modelica model beside the rig."""
    return table.fmu.endswith(MODEL_SUFFIX)


def _class(table: PlantTable) -> str:
    """The name of the model of a plant: an own one has that of its file."""
    return Path(table.fmu).stem if _is_own(table) else table.fmu


def _refuse(settings: Settings, plants: Mapping[str, PlantTable]) -> None:
    """Stop with everything that has no place in the package."""
    found = [
        f"plant {name}: {Path(table.fmu).name} is no {MODEL_SUFFIX} and not of the library"
        for name, table in plants.items()
        if table.fmu not in MODELS and not _is_own(table)
    ]
    files = {Path(table.fmu) for table in plants.values() if _is_own(table)}
    if len({file.parent for file in files}) > 1:
        found.append("own models are in several folders; one can be exported")
    for name, table in plants.items():
        for coordinate, axis in table.wire.items():
            owner = _owner(settings, axis)
            if owner not in plants:
                found.append(f"plant {name} is wired to {axis}, which is not simulated here")
            elif _is_rotary(plants[owner]) or _turns(table, coordinate):
                found.append(f"plant {name} is wired to {axis}, a rotary axis")
            elif plants[owner].fmu == _KINEMATIC and table.fmu in _TOUCH_PROBES:
                found.append(
                    f"plant {name}: the compiler takes no touch probe on {axis}, a KinematicAxis"
                )
        is_known = table.fmu in MODELS or _is_own(table)
        if is_known and table.wire and not _reads_motion(_described(table)):
            found.append(f"plant {name}: {table.fmu} is wired and reads no motion of an axis")
    if not plants:
        found.append("every axis of it is outside")
    if found:
        raise UserError(
            "this rig cannot be exported: " + "; ".join(found),
            file=settings.files[0],
            hint="take those plants out of a copy of the rig, or export their FMUs by hand",
        )


def _is_rotary(table: PlantTable) -> bool:
    if not _is_own(table):
        return table.fmu == _ROTARY
    variables = _described(table).modelVariables
    return any(v.name == "position" and unit_of(v) == "rad" for v in variables)


def _turns(table: PlantTable, coordinate: str) -> bool:
    """Whether the map of a sensor makes an angle of the position of an axis."""
    entry = table.map.get(f"{coordinate}_start")
    return isinstance(entry, MapTable) and entry.lead_mm is not None


def _owner(settings: Settings, axis: str) -> str:
    """The plant whose FMU an axis plant is in."""
    table = settings.rig.plant.get(axis)
    return (table and table.shares) or axis


def _reads_motion(description: ModelDescription) -> bool:
    return {v.name for v in description.modelVariables} >= set(_STEP)


def _groups(settings: Settings, plants: Mapping[str, PlantTable]) -> list[_Group]:
    """Axes and sensors that hang together, in the order of the first axis of each."""
    groups = [_Group([name]) for name, table in plants.items() if not table.wire]
    for name, table in plants.items():
        if table.wire:
            axes = {_owner(settings, axis) for axis in table.wire.values()}
            first, *others = [group for group in groups if axes & set(group.axes)]
            for other in others:
                first.axes += other.axes
                first.sensors += other.sensors
                groups.remove(other)
            first.sensors.append(name)
    return groups


def _part(settings: Settings, group: _Group, descriptions: Mapping[str, ModelDescription]) -> Part:
    plants = (*group.axes, *group.sensors)
    name = "_".join(group.axes)
    if not group.sensors:
        (axis,) = group.axes
        ports = tuple(Port(v.name, axis, v) for v in _shown(descriptions[axis], frozenset()))
        return Part(name, plants, settings.rig.plant[axis].fmu, ports)
    wired = {sensor: _wires(settings, sensor, descriptions[sensor]) for sensor in group.sensors}
    ports = tuple(
        Port(f"{plant}_{v.name}", plant, v)
        for plant in plants
        for v in _shown(descriptions[plant], frozenset(wired.get(plant, ())))
    )
    text = _joining(settings, f"Rig_{name}", plants, wired, ports)
    tables = [settings.rig.plant[plant] for plant in plants]
    own = dict.fromkeys(Path(table.fmu) for table in tables if _is_own(table))
    return Part(name, plants, None, ports, text, tuple(own))


def _shown(description: ModelDescription, inside: frozenset[str]) -> list[ModelVariable]:
    """The inputs and outputs of an FMU, but for inputs that are wired inside."""
    return [
        v
        for v in description.modelVariables
        if v.causality in ("input", "output") and v.name not in inside
    ]


def _wires(settings: Settings, sensor: str, description: ModelDescription) -> dict[str, str]:
    """What each input of a sensor for the motion of a step gets, as text of Modelica.

    The step begins now: its first position and rate are those of the axis at this instant.
    """
    wire = settings.rig.plant[sensor].wire
    given = {"step_time": "time", "step_size": "1"}
    for letter in "xyz":
        axis = wire.get(letter)
        at = f"{_owner(settings, axis)}.%s{settings.rig.plant[axis].suffix}" if axis else "0"
        for ending in _MOTION:
            kind = "velocity" if ending.startswith("rate") else "position"
            given[f"{letter}_{ending}"] = at % kind if axis else at
    names = {v.name for v in description.modelVariables}
    return {name: value for name, value in given.items() if name in names}


def _joining(
    settings: Settings,
    model: str,
    plants: Sequence[str],
    wired: Mapping[str, Mapping[str, str]],
    ports: Sequence[Port],
) -> str:
    """The text of a model that holds the plants, joins them, and shows the rest."""
    lines = [f'model {model} "Plants {", ".join(plants)} of a rig"']
    if any(_is_own(settings.rig.plant[plant]) for plant in plants):
        lines.append("  import AxisRig;")  # rumoca loads what the first file names
    lines += [f"  {_class(settings.rig.plant[plant])} {plant};" for plant in plants]
    lines += [_declaration(port) for port in ports]
    lines.append("equation")
    for sensor, inputs in wired.items():
        lines += [f"  {sensor}.{name} = {value};" for name, value in inputs.items()]
    for port in ports:
        inner = f"{port.plant}.{port.variable.name}"
        pair = (inner, port.name) if port.variable.causality == "input" else (port.name, inner)
        lines.append(f"  {pair[0]} = {pair[1]};")
    early = [p.name for p in ports if p.variable.name in _LEVELS and p.plant in wired]
    lines.append(f'  annotation(__axisrig(returns_early = "{", ".join(early)}"));')
    return "\n".join([*lines, f"end {model};", ""])


def _declaration(port: Port) -> str:
    """An input or output of the joining model, with unit, limits and start of the plant's."""
    variable = port.variable
    words = {"unit": f'"{unit}"'} if (unit := unit_of(variable)) else {}
    if port.type != "Boolean":
        limits = {"min": variable.min, "max": variable.max}
        words |= {name: str(value) for name, value in limits.items() if value is not None}
    if variable.causality == "input" and variable.start is not None:
        words["start"] = str(variable.start)
    inside = ", ".join(f"{name} = {value}" for name, value in words.items())
    text = (variable.description or "").replace('"', "'")
    changes = f"({inside})" if inside else ""
    return f'  {variable.causality} {port.type} {port.name}{changes} "{text}";'


def unit_of(variable: ModelVariable) -> str | None:
    """The unit of a variable, or that of its type."""
    declared = variable.declaredType
    return variable.unit or (declared.unit if declared is not None else None)
