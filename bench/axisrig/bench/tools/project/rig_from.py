"""`axisrig rig from LIST...`: a rig for the lists of a machine, with what it had to assume.

What no list says (bus, node numbers, mechanics, probe) is assumed, written down as `assumed` at the
top of the rig, and counted by `axisrig check` until its line is deleted.
"""

import os
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from axisrig.bench.rig.contents import read_parts
from axisrig.bench.rig.reading.encoder_resolution import counted_keys, listed_resolution
from axisrig.bench.rig.reading.influence import CHANNEL, classified
from axisrig.kernel.errors import UserError
from axisrig.kernel.parameters import ParameterSet, written
from axisrig.kernel.parameters.start_up import drive_type

INCREMENTS, LEAD_MM, RATE = 1_048_576, 10.0, 1_000_000
SURFACE_MM, CLEAR_MM = 100, 30
INPUTS = ("x", "y", "z")
"""Inputs of the touch probe, taken by the axes that measure in their order."""


@dataclass
class _Draft:
    """The tables of a rig as text, and what they rest on."""

    tables: list[str] = field(default_factory=list)
    assumed: list[str] = field(default_factory=list)

    def add(self, title: str, *lines: str) -> None:
        self.tables.append("\n".join([f"[{title}]", *lines, ""]))


def rig_from(lists: Sequence[Path], eds: Path | None, output: Path) -> list[str]:
    """Write a rig for axis lists and, where one is among them, a channel list.

    eds: of the drives. Returns what was assumed. Raises UserError for lists without an axis, names
    that are no axes or there twice, and a file that is there already.
    """
    if output.exists():
        raise UserError("the file is there already", file=output, hint="name a new one")
    axes: dict[str, tuple[Path, ParameterSet]] = {}
    channel: Path | None = None
    for path in lists:
        for name, parameters in read_parts(path).items():
            if parameters.kind == "channel":
                channel = path
            elif parameters.kind == "axis":
                _take_axis(axes, name, path, parameters)
            else:
                raise UserError("neither an axis list nor a channel list", file=path)
    if not axes:
        raise UserError("no axis list is among the files", value=str(lists[0]))
    draft = _Draft()
    if channel is None:
        output.parent.mkdir(parents=True, exist_ok=True)
        channel = output.with_name(f"{output.stem}-channel.lst")
        channel.write_text("# no channel list was given: all defaults\n", encoding="utf-8")
        draft.assumed.append(f"the channel has the defaults of all its parameters ({channel.name})")
        keys = []
    else:
        keys = _accept(draft, "channel", read_parts(channel)[CHANNEL])
    draft.add("channel", f'list = "{_relative(channel, output)}"', *keys)
    measuring = [name for name, (_, p) in axes.items() if p.flag("kenngr.messachse")]
    for number, (name, (path, parameters)) in enumerate(axes.items(), 1):
        _axis(draft, name, _relative(path, output), parameters, number, eds, output, measuring)
    _probe(draft, measuring)
    _write(draft, lists, output)
    return draft.assumed


def _take_axis(
    axes: dict[str, tuple[Path, ParameterSet]], name: str, path: Path, parameters: ParameterSet
) -> None:
    if name.startswith("#"):
        raise UserError("the list does not name its axis", file=path, allowed="kopf.log_achs_name")
    if name in axes:
        raise UserError("two lists are of the same axis", file=path, value=name)
    axes[name] = path, parameters


def _axis(
    draft: _Draft,
    name: str,
    path: str,
    parameters: ParameterSet,
    number: int,
    eds: Path | None,
    output: Path,
    measuring: Sequence[str],
) -> None:
    """Add bus, drive, axis and plant of one axis."""
    low = name.lower()
    draft.add(f"segment.can{number}", f"bitrate = {RATE}")
    draft.assumed.append(
        f"axis {name}: drive with node {number} alone on segment can{number}, {RATE // 1000} kbit/s"
    )
    draft.add(f"drive.{low}", *_drive(draft, name, parameters, eds, output))
    keys = [f'list = "{path}"', f'segment = "can{number}"', f"node = {number}"]
    keys += [f'drive = "{low}"', f'plant = "{low}"']
    if name in measuring[: len(INPUTS)]:
        keys += ['probe_1 = "probe"', 'probe_2 = "probe"']
    if simulated := parameters.integer("meas_simu.meas_simu_mode"):
        draft.assumed.append(
            f"axis {name}: it measures with the simulated probe of the list (P-AXIS-00112 ="
            f" {simulated}); the probe of the rig is not asked"
        )
    keys += _accept(draft, f"axis {name}", parameters)
    draft.add(f"axis.{name}", *keys)
    start_mm = _start_mm(parameters)
    draft.add(
        f"plant.{low}",
        'fmu = "AxisRig.Drives.ServoAxis"',
        f"start = {{ position_start_mm = {start_mm:g} }}",
    )
    draft.assumed.append(
        f"axis {name}: mechanics and loops are those of AxisRig.Drives.ServoAxis; it begins at"
        f" {start_mm:g} mm"
    )


def _accept(draft: _Draft, name: str, parameters: ParameterSet) -> list[str]:
    """Return the key that accepts what does not act of a list; nothing where there is nothing."""
    accepted = {}
    counted = counted_keys(parameters) if parameters.kind == "axis" else ()
    for row, key, value, group in classified(parameters):
        if group.must_act and key not in counted:
            accepted[row.number or row.path] = (
                f"{key} = {written(value)} does not act: {group.reason}"
            )
    draft.assumed += [f"{name}: {text}" for text in accepted.values()]
    words = ", ".join(f'"{word}"' for word in accepted)
    return [f"accept = [{words}]"] if accepted else []


def _drive(
    draft: _Draft, name: str, parameters: ParameterSet, eds: Path | None, output: Path
) -> list[str]:
    """Return the keys of a drive: encoder of the list, EDS, another type of drive."""
    increments, lead_mm, source = INCREMENTS, LEAD_MM, ", since the list does not say"
    if resolution := listed_resolution(parameters):
        increments, lead_mm = resolution.increments, float(resolution.path_mm)
        source = f" ({resolution.numbers})"
    draft.assumed.append(
        f"axis {name}: one revolution of the motor is {increments} increments and {lead_mm:g}"
        f" mm{source}"
    )
    keys = [f"encoder_increments = {increments}", f"lead_mm = {lead_mm!r}"]
    if eds is not None:
        keys.insert(0, f'eds = "{_relative(eds, output)}"')
    kind = drive_type(parameters)
    if kind.family != "canopen":
        keys.append("as_canopen = true")
        draft.assumed.append(f"axis {name}: a CANopen drive in place of {kind.name} (P-AXIS-00020)")
    return keys


def _start_mm(parameters: ParameterSet) -> float:
    """Return where an axis begins: clear of the surface, inside its software limits."""
    low, high = parameters.mm("kenngr.swe_neg"), parameters.mm("kenngr.swe_pos")
    wanted = float(SURFACE_MM + CLEAR_MM)
    return wanted if low < wanted < high else (low + high) / 2


def _probe(draft: _Draft, measuring: Sequence[str]) -> None:
    if not measuring:
        return
    # The last one of few is usually the axis of the tool
    inputs = INPUTS[-1:] if len(measuring) == 1 else INPUTS
    wires = dict(zip(inputs, measuring, strict=False))
    wire = ", ".join(f'{where} = "{name.lower()}"' for where, name in wires.items())
    draft.add(
        "plant.probe",
        'fmu = "AxisRig.Sensors.TouchProbe"',
        f"start = {{ surface_mm = {SURFACE_MM} }}",
        f"wire = {{ {wire} }}",
    )
    draft.assumed.append(
        f"a touch probe on {', '.join(wires.values())}, above a surface at {SURFACE_MM} mm of input"
        f" {[*wires][-1]}"
    )
    left = measuring[len(INPUTS) :]
    if left:
        draft.assumed.append(f"no probe on {', '.join(left)}: a touch probe has three inputs")


def _relative(path: Path, output: Path) -> str:
    return Path(os.path.relpath(path, output.parent)).as_posix()


def _write(draft: _Draft, lists: Sequence[Path], output: Path) -> None:
    quoted = [text.replace("\\", "\\\\").replace('"', '\\"') for text in draft.assumed]
    head = [
        "# Written by `axisrig rig from`. Delete each line of `assumed` when you have confirmed",
        "# it, or put it right below; `axisrig check` counts what is left.",
        f'title = "machine of {", ".join(path.name for path in lists)}"',
        "assumed = [",
        *(f'    "{text}",' for text in quoted),
        "]",
        "",
    ]
    output.write_text("\n".join([*head, *draft.tables]), encoding="utf-8")
