"""The package: SystemStructure.ssd, the FMUs, and the values of the rig (SSP 1.0).

Source: System Structure and Parameterization 1.0, Modelica Association, 2019, chapters 5 and 6.
"""

import shutil
import tempfile
import xml.etree.ElementTree as ET
import zipfile
from collections.abc import Mapping, Sequence
from pathlib import Path

from axisrig.bench.machine.plants import build_plant
from axisrig.bench.plan.assignment import parse_assignment
from axisrig.bench.rig.reading.file import MODEL_SUFFIX, PlantTable
from axisrig.bench.rig.real_axes import simulated_plants
from axisrig.bench.rig.settings import Settings
from axisrig.bench.tools.rig_export.parts import Part, Port, parts_of, unit_of
from axisrig.fmus import BuildError, ensure_built
from axisrig.fmus.build import build
from axisrig.kernel.cosim.fmi.fmu import FmuSlave
from axisrig.kernel.cosim.fmi.units import known_units
from axisrig.kernel.errors import UserError

SUFFIX = ".ssp"
_SSD = "http://ssp-standard.org/SSP1/SystemStructureDescription"
_SSC = "http://ssp-standard.org/SSP1/SystemStructureCommon"
_SSV = "http://ssp-standard.org/SSP1/SystemStructureParameterValues"
_FMU = "application/x-fmu-sharedlibrary"
_BASES = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")
_DATE = (1980, 1, 1, 0, 0, 0)


def export_rig(settings: Settings, target: Path, fmi: str) -> list[str]:
    """Write the plants of a rig as one package, and say in words what is in it and what not.

    fmi: version of the FMUs. Raises UserError when something of the rig cannot be exported, or the
    file cannot be written.
    """
    parts = parts_of(settings)
    values = _values(settings)
    files = {"SystemStructure.ssd": _structure(settings, parts)}
    for part in parts:
        files[f"resources/{part.name}.fmu"] = _fmu(part, fmi)
        files[f"resources/{part.name}.ssv"] = _parameters(settings, part, values)
    _write(target, files)
    return _in_words(settings, parts, target)


def _fmu(part: Part, fmi: str) -> bytes:
    """The bytes of an FMU: of the library, or built from the model that joins several."""
    try:
        if part.model is not None and not part.model.endswith(MODEL_SUFFIX):
            return ensure_built(part.model, fmi=fmi).read_bytes()
        with tempfile.TemporaryDirectory(prefix="axisrig-") as folder:
            if part.model is not None:
                own = Path(part.model)
                return build(own.stem, Path(folder) / "own.fmu", own, fmi=fmi).read_bytes()
            source = Path(folder) / f"Rig_{part.name}.mo"
            for beside in {file.parent for file in part.own}:  # one folder: what they use is there
                for file in sorted(beside.glob(f"*{MODEL_SUFFIX}")):
                    shutil.copy(file, folder)
            source.write_text(part.text, encoding="utf-8")
            return build(source.stem, source.with_suffix(".fmu"), source, fmi=fmi).read_bytes()
    except BuildError as error:
        raise UserError(
            f"the plants {', '.join(part.plants)} cannot be one FMU: {error}"
        ) from error


_Value = tuple[str, float]
"""Type of a variable of FMI 3.0, and its value."""


def _values(settings: Settings) -> dict[str, dict[str, _Value]]:
    """What the rig sets, by plant and variable, as its FMUs have it after initialisation."""
    plant = build_plant(settings)
    try:
        plant.initialize(0)
        slaves = {name: axis.slave for name, axis in plant.axes.items()}
        slaves |= {name: probe.slave for name, probe in plant.probes.items()}
        slaves |= {name: sensor.slave for name, sensor in plant.distances.items()}
        tables = simulated_plants(settings)
        return {
            name: {
                key: (str(slave.variable(key).type), slave.get(key))
                for key in _set_keys(settings, name, tables[name], slave)
            }
            for name, slave in slaves.items()
            if tables[name].shares is None
        }
    finally:
        plant.close()


def _set_keys(settings: Settings, name: str, table: PlantTable, slave: FmuSlave) -> list[str]:
    """The variables that the rig or an assignment sets, without the unit in its key."""
    items = [parse_assignment(f"plant:{name}.{key}=0") for key in table.start]
    items += [item for item, _ in settings.start.get(name, [])]
    keys = []
    for item in items:
        whole = item.column.partition(".")[2]
        keys.append(whole if slave.has(whole) else item.name)
    return list(dict.fromkeys(keys))


# --- texts -----------------------------------------------------------------------------------


def _text(root: ET.Element) -> bytes:
    ET.indent(root)
    text = ET.tostring(root, encoding="utf-8", xml_declaration=True)
    return bytes(text) + b"\n"


def _structure(settings: Settings, parts: Sequence[Part]) -> bytes:
    for prefix, space in (("ssd", _SSD), ("ssc", _SSC), ("ssv", _SSV)):
        ET.register_namespace(prefix, space)
    name = settings.files[0].stem
    root = ET.Element(f"{{{_SSD}}}SystemStructureDescription", version="1.0", name=name)
    root.set("generationTool", "axisrig")
    system = ET.SubElement(root, f"{{{_SSD}}}System", name=name, description=settings.rig.title)
    elements = ET.SubElement(system, f"{{{_SSD}}}Elements")
    for part in parts:
        attributes = {"name": part.name, "type": _FMU, "source": f"resources/{part.name}.fmu"}
        component = ET.SubElement(
            elements, f"{{{_SSD}}}Component", attributes, implementation="CoSimulation"
        )
        _connectors(component, part.ports)
        bindings = ET.SubElement(component, f"{{{_SSD}}}ParameterBindings")
        source = f"resources/{part.name}.ssv"
        ET.SubElement(bindings, f"{{{_SSD}}}ParameterBinding", source=source)
    _units(root, [port for part in parts for port in part.ports])
    ET.SubElement(root, f"{{{_SSD}}}DefaultExperiment", startTime="0", stopTime="1")
    return _text(root)


def _connectors(element: ET.Element, ports: Sequence[Port]) -> None:
    """The connectors of a component, with type and unit.

    The system itself has none: masters that cannot wire them (ecos, libcosim) refuse them, and the
    components are not wired to each other.
    """
    connectors = ET.SubElement(element, f"{{{_SSD}}}Connectors")
    for port in ports:
        kind = str(port.variable.causality)
        connector = ET.SubElement(connectors, f"{{{_SSD}}}Connector", name=port.name, kind=kind)
        unit = unit_of(port.variable)
        words = {"unit": unit} if port.type == "Real" and unit else {}
        ET.SubElement(connector, f"{{{_SSC}}}{port.type}", words)


def _units(root: ET.Element, ports: Sequence[Port]) -> None:
    units = ET.SubElement(root, f"{{{_SSD}}}Units")
    for name in sorted({u for port in ports if (u := unit_of(port.variable))}):
        unit = ET.SubElement(units, f"{{{_SSC}}}Unit", name=name)
        known = known_units()[name]
        words = {b: str(n) for b, n in zip(_BASES, known.exponents, strict=True) if n}
        if known.factor != 1.0:
            words["factor"] = repr(known.factor)
        ET.SubElement(unit, f"{{{_SSC}}}BaseUnit", words)


def _parameters(
    settings: Settings, part: Part, values: Mapping[str, Mapping[str, _Value]]
) -> bytes:
    """The values of one component. All sets have the name of the rig: ecos takes sets by name."""
    name = settings.files[0].stem
    root = ET.Element(f"{{{_SSV}}}ParameterSet", version="1.0", name=name)
    parameters = ET.SubElement(root, f"{{{_SSV}}}Parameters")
    for plant in part.plants:
        for variable, value in values.get(plant, {}).items():
            full = part.parameter(plant, variable)
            parameter = ET.SubElement(parameters, f"{{{_SSV}}}Parameter", name=full)
            kind, text = _as_text(*value)
            ET.SubElement(parameter, f"{{{_SSV}}}{kind}", value=text)
    return _text(root)


def _as_text(kind: str, value: float) -> tuple[str, str]:
    """The word of SSP for a type, and a value of it as text."""
    if kind == "Boolean":
        return "Boolean", "true" if value else "false"
    return ("Integer", str(int(value))) if kind.startswith("Int") else ("Real", repr(value))


def _write(target: Path, files: Mapping[str, bytes]) -> None:
    """Write an archive whose bytes depend on its content alone."""
    try:
        with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as archive:
            for name, content in files.items():
                archive.writestr(zipfile.ZipInfo(name, _DATE), content)
    except OSError as error:
        raise UserError("the package cannot be written", file=target, value=str(error)) from error


def _in_words(settings: Settings, parts: Sequence[Part], target: Path) -> list[str]:
    """Say what the package holds, and which settings of the rig it does not hold."""
    lines = [f"{target}: {len(parts)} FMU{'' if len(parts) == 1 else 's'}"]
    for part in parts:
        what = part.model or f"joined from {', '.join(part.plants)}"
        lines.append(f"{part.name}: {what}")
    for name, table in simulated_plants(settings).items():
        if table.map:
            lines.append(
                f"plant {name}: its map is not in the package; its variables keep their names"
            )
        if table.stroke_mm is not None or table.breaks:
            lines.append(f"plant {name}: stroke_mm and breaks are checked by axisrig only")
    lines.append(
        "not in it: buses, drives' profiles, lists, the control; a demand comes from outside"
    )
    return lines
