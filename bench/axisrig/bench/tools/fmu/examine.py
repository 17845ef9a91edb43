"""What can be found out about an FMU without running its code."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree

import fmpy
from fmpy.model_description import ModelDescription, ModelVariable
from fmpy.validation import validate_model_description

from axisrig.bench.campaign.collector import without_collector
from axisrig.bench.tools.fmu.binaries import Binary, find_binaries, folder_platform
from axisrig.bench.tools.fmu.findings import Finding, fail, has_failed, ok, warn
from axisrig.bench.tools.fmu.stepped_instance import readable_outputs
from axisrig.kernel.cosim.fmi.archive import DESCRIPTION, MIB, inspect, unpack
from axisrig.kernel.cosim.fmi.fmu import load_description, read_description
from axisrig.kernel.cosim.fmi.library import Capabilities
from axisrig.kernel.cosim.fmi.rules import bad_names, by_rule
from axisrig.kernel.cosim.fmi.units import find_unit, unit_name
from axisrig.kernel.errors import UserError

_SHOWN_MAX = 6
_REALS = ("Real", "Float64", "Float32")
_NUMBERS = (*_REALS, "Integer", *(f"{u}Int{n}" for u in ("", "U") for n in (8, 16, 32, 64)))


@dataclass(frozen=True)
class Examined:
    """What was found; can_run: nothing speaks against loading it here."""

    findings: list[Finding]
    sha256: str
    can_run: bool


def examine(path: Path, is_strict: bool = False) -> Examined:
    """Judge archive, description and libraries.

    is_strict: a rule of the standard that the description breaks is a FAIL, also where the bench
    does not depend on it. Raises UserError when there is no file.
    """
    if not path.exists() or path.is_dir():
        unpack(path)  # says what is wrong
    with without_collector():
        return _examined(path, is_strict)


def _examined(path: Path, is_strict: bool) -> Examined:
    try:
        archive = inspect(path)
    except UserError as error:
        return Examined([_failure("archive", error)], "", False)
    size = sum(entry.size for entry in archive.entries)
    text = f"{len(archive.entries)} entries, {size / MIB:.2f} MiB, nothing leaves its folder"
    findings = [ok("archive", text)]
    findings += _description(unpack(path), is_strict=is_strict)
    if has_failed(findings):
        return Examined(findings, archive.sha256, False)
    description, folder = load_description_findings(path, findings)
    if description is not None:
        findings += _binaries(description, folder)
        findings += _capabilities(description, folder)
        findings += _variables(description)
    return Examined(findings, archive.sha256, not has_failed(findings))


def _failure(area: str, error: UserError) -> Finding:
    """A FAIL in the words of an error; the reader of the table has its file."""
    parts = [error.message]
    if error.value is not None:
        parts.append(f"found {error.value}")
    if error.allowed is not None:
        parts.append(f"allowed: {error.allowed}")
    return fail(area, "; ".join(parts), error.hint or "")


def load_description_findings(
    path: Path, findings: list[Finding]
) -> tuple[ModelDescription | None, Path]:
    """Load the description as a rig does; what it is refused for is added to `findings`."""
    try:
        description, folder = load_description(path)
    except UserError as error:
        findings.append(_failure("usable here", error))
        return None, path
    return description, Path(folder)


def _description(folder: Path, *, is_strict: bool) -> Iterator[Finding]:
    """Hold the description to its version, the schema and what fmpy checks besides."""
    area = "description"
    version = _version(folder)
    if not version.startswith(("2.", "3.")):
        text = f"FMI version {version or 'missing'}"
        yield fail(area, text, "export it as FMI 2.0 or 3.0 for co-simulation")
        return
    try:
        description, problems = _read(folder)
        broken = by_rule([*problems, *bad_names(description)])
    except Exception as error:  # fmpy: an unknown version or a missing element is any Exception
        text = f"it cannot be read: {str(error) or type(error).__name__}"
        yield fail(area, text, "export it again")
        return
    for rule, of_rule in broken.items():
        more = f" (and {len(of_rule) - 1} more)" if len(of_rule) > 1 else ""
        text = f"{rule.name}: {of_rule[0]}{more}"
        if is_strict or not rule.runs:
            yield fail(area, text, "report it to the maker of the tool that exported it")
        else:
            yield warn(area, text, "the bench does not depend on it; other tools may")
    tool = description.generationTool or "a tool that it does not name"
    text = f"FMI {description.fmiVersion}, model {description.modelName}, by {tool}"
    yield ok(area, text + ("" if broken else "; valid"))


def _version(folder: Path) -> str:
    """The version in the root element; the document is known to be well-formed."""
    _, root = next(ElementTree.iterparse(folder / DESCRIPTION, events=("start",)))
    return str(root.get("fmiVersion", ""))


def _read(folder: Path) -> tuple[ModelDescription, list[str]]:
    """Read a description; return it with what fmpy dislikes of it, of its structure too.

    Where it is against the schema, fmpy looks no further.
    """
    description, problems = read_description(folder)
    try:
        found = validate_model_description(description, validate_model_structure=True)
    except Exception:  # fmpy counts on the schema
        if not problems:
            raise
        found = []
    all_of_fmpy = [str(problem) for problem in found]
    return description, all_of_fmpy if {*problems} <= {*all_of_fmpy} else list(problems)


def _binaries(description: ModelDescription, folder: Path) -> Iterator[Finding]:
    area = "platforms"
    binaries = find_binaries(folder, str(description.coSimulation.modelIdentifier))
    here = _folder_here(description)
    found = next((binary for binary in binaries if binary.folder == here), None)
    if found is None:
        yield fail(
            area,
            f"binaries/{here} holds no library {description.coSimulation.modelIdentifier}",
            "the name of the library must be the model identifier",
        )
    for binary in binaries:
        if not binary.is_in_place:
            yield _misplaced(binary, is_here=binary is found)
    yield ok(area, ", ".join(str(binary) for binary in binaries) or "none")


def _misplaced(binary: Binary, *, is_here: bool) -> Finding:
    system, processor = folder_platform(binary.folder)
    text = f"{binary.folder} says {processor} on {system}, its library is {binary}"
    level = fail if is_here else warn
    return level("platforms", text, "pack the library into the folder of its own platform")


def _folder_here(description: ModelDescription) -> str:
    is_fmi2 = str(description.fmiVersion).startswith("2.")
    return str(fmpy.platform if is_fmi2 else fmpy.platform_tuple)


def _capabilities(description: ModelDescription, folder: Path) -> Iterator[Finding]:
    area, can = "capabilities", Capabilities.of(description, folder)
    said = {
        "saves its state": can.can_save_state,
        "serialises it": can.can_serialize_state,
        "returns early": can.can_return_early,
        "takes steps of any length": can.can_vary_step,
    }
    text = "; ".join(f"{what}: {'yes' if is_so else 'no'}" for what, is_so in said.items())
    yield ok(area, text)
    if not can.can_vary_step:
        yield warn(
            area,
            "it takes steps of one length only",
            "it is stepped on its own grid and its outputs hold between (docs/rigs.md)",
        )
    if can.needs_tool:
        yield warn(area, "it needs the tool that made it", "install that tool where rigs run")
    if can.once_per_process:
        yield warn(area, "it may exist once in a process", "name it once in a rig")
    if not can.can_save_state:
        yield warn(
            area,
            "its state cannot be saved: an edge of a signal is found by sub-steps only",
            "export it with canGetAndSetFMUState where the tool offers that",
        )


def _variables(description: ModelDescription) -> Iterator[Finding]:
    area, variables = "variables", list(description.modelVariables)
    kinds = ("input", "output", "parameter", "local")
    counts = {kind: sum(v.causality == kind for v in variables) for kind in kinds}
    yield ok(area, ", ".join(f"{count} {kind}s" for kind, count in counts.items()))
    if not readable_outputs(description):
        yield warn(area, "it has no outputs", "the bench has nothing to read")
    clocked = [v.name for v in variables if v.type == "Clock" or v.clocks]
    if clocked:
        text = f"it needs event mode, which is not there: clocks are not ticked: {_some(clocked)}"
        yield warn(area, text, "what a clock triggers keeps its start value; export it without")
    elif str(getattr(description.coSimulation, "hasEventMode", "")).lower() == "true":
        yield ok(area, "it has event mode and no clocks: it is stepped without, which it must bear")
    outside = [text for text in (_out_of_range(v) for v in variables) if text]
    if outside:
        yield warn(area, f"start outside min .. max: {_some(outside)}", "set it in the rig")
    yield from _units(description, variables)


def _out_of_range(variable: ModelVariable) -> str | None:
    """Name a start value that its own limits forbid."""
    if variable.type not in _NUMBERS or variable.start is None or variable.causality == "local":
        return None
    low = float(variable.min) if variable.min is not None else -math.inf
    high = float(variable.max) if variable.max is not None else math.inf
    values = [float(text) for text in str(variable.start).split()]
    wrong = [value for value in values if not low <= value <= high]
    return f"{variable.name} = {wrong[0]:g} ({low:g} .. {high:g})" if wrong else None


def _units(description: ModelDescription, variables: Sequence[ModelVariable]) -> Iterator[Finding]:
    area = "units"
    shown = [v for v in variables if v.causality in ("input", "output") and v.type in _REALS]
    bare = [v.name for v in shown if unit_name(v) is None]
    names = {name for v in shown if (name := unit_name(v)) is not None}
    unknown = sorted(name for name in names if find_unit(description, name) is None)
    if unknown:
        yield warn(area, f"units not known: {_some(unknown)}", "give them in the map of the rig")
    if bare:
        yield warn(area, f"without a unit: {_some(bare)}", "give the unit in the map of the rig")
    if not unknown and not bare:
        yield ok(area, f"known: {_some(sorted(names))}" if names else "nothing has one")


def _some(names: Sequence[str]) -> str:
    more = f" and {len(names) - _SHOWN_MAX} more" if len(names) > _SHOWN_MAX else ""
    return ", ".join(names[:_SHOWN_MAX]) + more
