"""Checks of a rig after its form: how parts are wired, then what each family of drives asks."""

import re
from collections import Counter
from pathlib import Path

from axisrig.bench.plan.composition import Mistakes
from axisrig.bench.rig.families import family_of, rig_families
from axisrig.bench.rig.faults import check_faults
from axisrig.bench.rig.plc.words import ObjectWrite
from axisrig.bench.rig.reading.families import carriers_of, joined
from axisrig.bench.rig.reading.file import error_at, rig_error
from axisrig.bench.rig.reading.lists import check_drive_types, check_numbers
from axisrig.bench.rig.real_axes import check_outside
from axisrig.bench.rig.refused_setting import blamed
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.errors import UserError, near_files

# The letters of addresses that NC programs give to axes (F, G, M, N, S, T, D mean other things)
_AXIS_NAME = re.compile(r"[ABCQUVWXYZ](?:[0-9]{0,3}|[0-9]*_[A-Za-z0-9_]{1,30})")


def check_rig(settings: Settings) -> None:
    """Check how the parts are wired, and what each carrier asks of its drives and segments.

    Raises UserError with file, line and key of the rig, one for each mistake that does not follow
    from another one; with the place of the cell or `--set` where the rig would do without it.
    """
    try:
        _check_rig(settings)
    except UserError as error:
        raise blamed(error, settings, _check_rig) from error


def _check_rig(settings: Settings) -> None:
    _check_references(settings)
    mistakes = Mistakes()
    for step in (*_WIRING, *(family.check_addresses for family in rig_families())):
        with mistakes.kept():
            step(settings)
    is_wired = not mistakes
    for step in _PARTS:
        with mistakes.kept():
            step(settings)
    if is_wired:  # what a family reckons with follows from all of it
        for step in _OF_DRIVES:
            with mistakes.kept():
                step(settings)
        for family in rig_families() if not mistakes else ():
            with mistakes.kept():
                family.check(settings)
    mistakes.refuse(settings.files[0])


def _check_cycle(settings: Settings) -> None:
    """Refuse an NC cycle that does not begin within the period."""
    cycle = settings.rig.cycle
    if cycle.cycle_offset_us >= cycle.period_us:
        raise rig_error(
            settings.files,
            ("cycle", "cycle_offset_us"),
            "the NC cycle must start within the period",
            value=cycle.cycle_offset_us,
            allowed=f"0 .. {cycle.period_us - 1} us",
        )


def _check_references(settings: Settings) -> None:
    """Refuse a rig without an axis, or with a PLC program that is no file."""
    rig, files = settings.rig, settings.files
    if not rig.axis:
        raise rig_error(files, ("axis",), "the rig has no axis")
    task = rig.plc_task
    if task is not None and not Path(task.program).is_file():
        found = {"value": task.program, "hint": near_files(Path(), task.program)}
        raise rig_error(files, ("plc", "program"), "the PLC program is no file", **found)


def _check_carriers(settings: Settings) -> None:
    """Refuse a drive on a segment that does not carry its words."""
    rig = settings.rig
    for name, axis in rig.axis.items():
        drive, carrier = rig.drive[axis.drive], settings.segment[axis.segment].carrier
        family = drive.family_name
        if joined(family, carrier) is None:
            assumed = "" if drive.family else f", which drive {axis.drive} is as it names no family"
            raise rig_error(
                settings.files,
                ("axis", name, "segment"),
                f"axis {name}: segment {axis.segment} (carrier {carrier}) does not carry drives of"
                f" the family {family}{assumed}",
                value=carrier,
                allowed=carriers_of(family),
            )


def _check_drives(settings: Settings) -> None:
    for name, drive in settings.rig.drive.items():
        try:
            drive.facts()
        except UserError as error:
            raise error_at(settings.files, ("drive", name), error) from error


def _check_objects(settings: Settings) -> None:
    """Refuse columns that write to objects of a drive that has none."""
    for rule in settings.plc:
        write = rule.action
        if isinstance(write, ObjectWrite) and not family_of(settings, write.axis).has_objects:
            drive = settings.rig.axis[write.axis].drive
            raise rig_error(
                settings.files,
                ("axis", write.axis),
                f"{rule.column}: drive {drive} of axis {write.axis} has no objects",
                value=settings.rig.drive[drive].family_name,
            )


def _check_plants(settings: Settings) -> None:
    plants = Counter(axis.plant for axis in settings.rig.axis.values())
    for name, axis in settings.rig.axis.items():
        if plants[axis.plant] > 1:
            raise rig_error(
                settings.files,
                ("axis", name, "plant"),
                "two axes cannot drive one plant",
                value=axis.plant,
            )


def _check_names(settings: Settings) -> None:
    spelled: dict[str, str] = {}
    for name, axis in settings.rig.axis.items():
        other = spelled.setdefault(name.upper(), name)
        if other != name or not _AXIS_NAME.fullmatch(name):
            raise rig_error(
                settings.files,
                ("axis", name),
                "an axis needs a name of its own that is no other word of an NC program",
                value=name,
                allowed="one of A B C Q U V W X Y Z, such a letter with digits, or X2_Table",
            )
        listed = settings.axis[name].word("kopf.log_achs_name")
        if listed and listed != name:
            raise UserError(
                f"the list belongs to axis {listed}, the rig uses it for axis {name}",
                file=axis.list,
                value=listed,
                allowed=name,
            )


_WIRING = (_check_carriers,)
"""What the other checks rely on."""
_PARTS = (
    _check_plants,
    _check_names,
    _check_drives,
    _check_cycle,
    lambda settings: check_numbers(settings.axis),
)
"""Checks of parts by themselves."""
_OF_DRIVES = (
    lambda settings: check_drive_types(settings.rig, settings.axis),
    check_outside,
    check_faults,
    _check_objects,
)
"""Checks of drives on what carries them."""
