"""`axisrig fmu show FILE`: what an FMU says about itself. Nothing of its code is run."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import fmpy
from fmpy.model_description import ModelDescription, ModelVariable, Unknown
from rich import box
from rich.console import Console
from rich.table import Table as RichTable

from axisrig.bench.campaign.collector import without_collector
from axisrig.bench.tools.fmu.binaries import Binary, find_binaries
from axisrig.kernel.cosim.fmi.archive import MIB, Archive, inspect, unpack
from axisrig.kernel.cosim.fmi.library import Capabilities
from axisrig.kernel.cosim.fmi.units import unit_name
from axisrig.kernel.errors import UserError, printable

_KINDS = ("structuralParameter", "parameter", "calculatedParameter", "input", "output")
_COLUMNS = ("variable", "causality", "type", "unit", "start")
_MORE_COLUMNS = ("variability", "min", "max", "description")
_WIDE = 120  # a window of so many signs holds all columns
_UNLIMITED = 100_000


@dataclass(frozen=True)
class Shown:
    """An FMU that was read: its archive, what it says and promises, and its libraries.

    can: None without an interface for co-simulation.
    """

    archive: Archive
    description: ModelDescription
    can: Capabilities | None
    binaries: list[Binary]


def read_fmu(path: Path) -> Shown:
    """Read an FMU of any version. Raises UserError for a file that is none, or no safe one."""
    folder = unpack(path)
    try:
        with without_collector():
            description = fmpy.read_model_description(str(folder), validate=False)
        has_steps = description.coSimulation is not None
        can = Capabilities.of(description, folder) if has_steps else None
    except Exception as error:  # fmpy reports what it cannot read by any Exception
        text = str(error).partition("\n")[0] or type(error).__name__
        raise UserError(
            f"the model description is rejected: {text}",
            file=path,
            hint="axisrig fmu check FILE lists what is wrong",
        ) from error
    identifiers = {str(each.modelIdentifier) for each in _interfaces(description).values()}
    binaries = [found for name in sorted(identifiers) for found in find_binaries(folder, name)]
    return Shown(inspect(path), description, can, binaries)


def _interfaces(description: ModelDescription) -> dict[str, Any]:
    interfaces = {
        "co-simulation": description.coSimulation,
        "model exchange": description.modelExchange,
        "scheduled execution": description.scheduledExecution,
    }
    return {name: interface for name, interface in interfaces.items() if interface is not None}


def show_fmu(shown: Shown, *, is_all: bool) -> None:
    """Print everything about an FMU on standard output. is_all: local variables too."""
    console = Console(highlight=False, markup=False, emoji=False)
    if not console.is_terminal:  # a file or a pipe has no width: a broken name cannot be searched
        console.width = _UNLIMITED
    is_wide = console.width >= _WIDE
    for label, text in _head(shown):
        console.print(f"{label:<14}{printable(text)}", soft_wrap=True)
    variables = list(shown.description.modelVariables)
    listed = [v for v in variables if is_all or v.causality in _KINDS]
    console.print()
    console.print(_variables(listed, (*_COLUMNS, *_MORE_COLUMNS) if is_wide else _COLUMNS))
    if not is_wide:
        console.print(f"a window of {_WIDE} columns, or a file, shows {', '.join(_MORE_COLUMNS)}")
    hidden = len(variables) - len(listed)
    if hidden:
        console.print(f"{hidden} variables, local ones and time, are not shown; --all shows them")
    console.print()
    for line in _structure(shown.description):
        console.print(printable(line), soft_wrap=True)


def _head(shown: Shown) -> Iterator[tuple[str, str]]:
    archive, description = shown.archive, shown.description
    size = sum(entry.size for entry in archive.entries)
    yield "file", str(archive.path)
    yield "size", f"{archive.size} bytes, {size / MIB:.2f} MiB in {len(archive.entries)} entries"
    yield "sha256", archive.sha256
    yield "model", str(description.modelName)
    facts = {
        "description": description.description,
        "version": description.version,
        "author": description.author,
        "license": description.license,
        "tool": description.generationTool,
        "made": description.generationDateAndTime,
    }
    yield from ((label, str(text)) for label, text in facts.items() if text)
    yield (
        "FMI",
        f"{description.fmiVersion}, {', '.join(_interfaces(description)) or 'no interface'}",
    )
    yield from (("platform", _platform(binary)) for binary in shown.binaries)
    if not shown.binaries:
        yield "platform", "none: sources only" if description.buildConfigurations else "none"
    if shown.can is not None:
        yield from (("can", text) for text in _capabilities(shown.can))
    yield from _experiment(description)


def _platform(binary: Binary) -> str:
    """Say for FMI 2.0's one folder of macOS what its library runs on."""
    text = str(binary)
    if binary.folder == "darwin64":
        text += (
            "; runs on Intel and Apple processors"
            if binary.is_universal
            else ("; not universal: FMI 2.0 has one folder for both processors of macOS")
        )
    return text


def _capabilities(can: Capabilities) -> Iterator[str]:
    said = (
        (can.can_vary_step, "take steps of any length"),
        (can.can_save_state, "save and restore its state"),
        (can.can_serialize_state, "write its state as bytes"),
        (can.can_return_early, "return early from a step"),
    )
    yield from (f"{what}: {'yes' if is_so else 'no'}" for is_so, what in said)
    if can.fixed_step_s is not None:
        yield f"internal step {can.fixed_step_s:g} s"
    if can.once_per_process:
        yield "exist once in a process only"
    if can.needs_tool:
        yield "run only with the tool that made it"


def _experiment(description: ModelDescription) -> Iterator[tuple[str, str]]:
    experiment = description.defaultExperiment
    if experiment is not None:
        said = {
            "start": experiment.startTime,
            "stop": experiment.stopTime,
            "step": experiment.stepSize,
        }
        text = ", ".join(f"{name} {value} s" for name, value in said.items() if value is not None)
        if text:
            yield "experiment", text


def _variables(variables: Sequence[ModelVariable], columns: Sequence[str]) -> RichTable:
    table = RichTable(box=box.SIMPLE_HEAD, pad_edge=False)
    for column in columns:
        table.add_column(column, overflow="fold", no_wrap=column == "causality")
    for variable in variables:
        shape = "".join(f"[{size}]" for size in variable.shape or ())
        cells = {
            "variable": variable.name,
            "causality": variable.causality,
            "variability": variable.variability,
            "type": f"{variable.type}{shape}",
            "unit": unit_name(variable),
            "start": variable.start,
            "min": variable.min,
            "max": variable.max,
            "description": variable.description,
        }
        texts = (cells[column] for column in columns)
        table.add_row(*("" if cell is None else printable(str(cell)) for cell in texts))
    return table


def _structure(description: ModelDescription) -> Iterator[str]:
    yield from ("structure", *(f"  {_depends(u)}" for u in description.outputs))
    counts = {
        "continuous states": len(description.derivatives),
        "event indicators": len(description.eventIndicators) or description.numberOfEventIndicators,
        "initial unknowns": len(description.initialUnknowns),
    }
    yield "  " + ", ".join(f"{count} {what}" for what, count in counts.items())


def _depends(unknown: Unknown) -> str:
    name = unknown.variable.name if unknown.variable is not None else "?"
    if unknown.dependencies is None:
        return f"{name}: dependencies are not given"
    kinds = unknown.dependenciesKind or ["dependent"] * len(unknown.dependencies)
    needed = [
        variable.name if kind == "dependent" else f"{variable.name} ({kind})"
        for variable, kind in zip(unknown.dependencies, kinds, strict=False)
    ]
    return f"{name}: depends on {', '.join(needed) or 'nothing'}"
