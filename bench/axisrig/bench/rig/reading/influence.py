"""Parameters of real lists that do not act: kept, counted, or refused with the reason."""

from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from pathlib import Path
from typing import NamedTuple

from axisrig.bench.rig.reading.encoder_resolution import counted_keys, listed_resolution
from axisrig.bench.rig.reading.file import RigFile, rig_error
from axisrig.kernel.errors import UserError, nearest, together
from axisrig.kernel.parameters import ParameterSet, written
from axisrig.kernel.parameters.influence import Group, group_of
from axisrig.kernel.parameters.table import Kind, Parameter, indices_of, table
from axisrig.kernel.parameters.types import Value

CHANNEL = "channel"
SPEED_SCALE = ("getriebe[0].multi_gain_z", "getriebe[0].multi_gain_n")
INNER_UNITS = {"resolution_factor": 10_000}
"""What means the same as the neutral value: 0 of P-CHAN-00315 is 10000."""


def influence_notes(
    rig: RigFile, files: list[Path], channel: ParameterSet, axes: Mapping[str, ParameterSet]
) -> list[str]:
    """Say of each list what has no influence here, and what was accepted though it would act.

    Raises UserError, for all lists together, for a parameter that would act on the machine, does
    not act here, is not at its neutral value and is not in `accept` of its axis or of the channel.
    """
    notes, errors = list[str](), list[UserError]()
    lists = [_List(CHANNEL, (CHANNEL,), rig.channel.list, rig.channel.accept, channel)]
    for name, parameters in axes.items():
        table_ = rig.axis[name]
        at = _List(f"axis {name}", ("axis", name), table_.list, table_.accept, parameters)
        lists.append(at)
    for one in lists:
        accepted = _accepted(files, one)
        without = 0
        for row, key, value, group in classified(one.parameters):
            if not group.must_act:
                without += 1
                continue
            resolutions = _resolutions(rig, one, key)
            if resolutions and resolutions[0] == resolutions[1]:
                continue
            if key in SPEED_SCALE and rig.drive[rig.axis[one.keys[-1]].drive].has_output:
                continue  # its family compares it with the drive
            if row.path in accepted:
                notes.append(
                    f"{one.name}: {_named(row, key)} = {written(value)} is accepted and does not"
                    f" act: {group.reason}"
                )
            else:
                errors.append(_refused(one, row, key, value, group, resolutions))
        if without:
            what = "1 setting has" if without == 1 else f"{without} settings have"
            notes.append(
                f"{one.name}: {what} no influence here ({Path(one.file).name});"
                " `axisrig params --rig` lists all that is set"
            )
    if errors:
        raise together(errors)
    return notes


class _List(NamedTuple):
    """A parameter list of a rig: how notes call it, its table, its file, what it accepts."""

    name: str
    keys: tuple[str, ...]
    file: str
    accept: Sequence[str]
    parameters: ParameterSet


def assumed_notes(rig: RigFile) -> list[str]:
    """Count what a rig rests on that nobody has confirmed."""
    count = len(rig.assumed)
    if not count:
        return []
    what = "1 assumption" if count == 1 else f"{count} assumptions"
    return [f"{what} of the rig not confirmed: delete each line of `assumed` once it is right"]


def classified(parameters: ParameterSet) -> Iterator[tuple[Parameter, str, Value, Group]]:
    """Yield what was set, is not at its neutral value and has a class."""
    for key, value in parameters.inert():
        row = table(parameters.kind).find(key)[0]
        group = group_of(parameters.kind, row.path)
        if group is not None and value != INNER_UNITS.get(row.path):
            yield row, key, value, group


def _accepted(files: list[Path], one: _List) -> set[str]:
    """Return the paths that a list accepts by number or path. Raises UserError for none."""
    found = set()
    kind = one.parameters.kind
    known = table(kind)
    for word in one.accept:
        row = known.numbered(word) or known.row(word)
        if row is None or not _must(row, kind):
            must = [r.number or r.path for r in known.parameters if _must(r, kind)]
            raise rig_error(
                files,
                (*one.keys, "accept"),
                "no parameter that has to be accepted",
                value=word,
                allowed=nearest(word, must) or must,
            )
        found.add(row.path)
    return found


def _must(row: Parameter, kind: Kind) -> bool:
    group = group_of(kind, row.path)
    return group is not None and group.must_act


def _resolutions(rig: RigFile, one: _List, key: str) -> tuple[Fraction, Fraction] | None:
    """Return increments per mm of list and rig where `key` is a part of that, else None."""
    parameters = one.parameters
    if parameters.kind != "axis" or key not in counted_keys(parameters):
        return None
    resolution = listed_resolution(parameters)
    assert resolution is not None
    drive = rig.drive[rig.axis[one.keys[-1]].drive]
    return resolution.per_mm, drive.facts().units_per_mm


def _refused(
    one: _List,
    row: Parameter,
    key: str,
    value: Value,
    group: Group,
    resolutions: tuple[Fraction, Fraction] | None,
) -> UserError:
    place = one.parameters.origin(key)
    assert place is not None
    word = row.number or row.path
    index = "" if indices_of(key) in ((), (0,)) else f" (index {indices_of(key)[0]})"
    allowed = f"{written(row.default)}, its neutral value"
    if resolutions is not None:
        unit = "degree" if one.parameters.is_rotary else "mm"
        listed, of_drive = (f"{float(number):.9g}" for number in resolutions)
        allowed = f"{of_drive} increments per {unit}, those of the drive; the list has {listed}"
    return place.error(
        f"{_named(row, key)}{index} does not act here: {group.reason}",
        value=written(value),
        allowed=allowed,
        hint=f'or accept = ["{word}"] in [{".".join(one.keys)}]: every run then says so',
    )


def _named(row: Parameter, key: str) -> str:
    return f"{key} ({row.number})" if row.number else key
