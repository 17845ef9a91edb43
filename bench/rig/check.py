"""Checks of a rig beyond its form: who is wired to whom, and whether the cycle fits on the bus."""

import re
from collections import Counter
from collections.abc import Mapping

from bench.bus.arithmetic import CycleArithmetic, PlannedFrame, cycle_arithmetic
from bench.rig.file import rig_error
from bench.rig.settings import Settings
from bench.rig.startup import drive_steps
from kernel.clock import US
from kernel.drives.ds402 import latch_object
from kernel.drives.mapping import Telegram, telegrams
from kernel.drives.startup_steps import BusSettings, Step
from kernel.errors import UserError

# The letters of addresses that NC programs give to axes (F, G, M, N, S, T, D mean other things)
_AXIS_NAME = re.compile(r"[ABCUVWXYZ][0-9]{0,3}")


def axis_telegrams(settings: Settings, name: str) -> dict[str, Telegram]:
    """Return the PDOs of one axis; the latch object follows from input and edge."""
    parameters = settings.axis[name]
    latch = latch_object(
        parameters.integer("kenngr.measure.input"), parameters.word("kenngr.measure.edge")
    )
    return telegrams(latch, settings.rig.drive[settings.rig.axis[name].drive].pdo_map)


def segment_schedules(settings: Settings) -> dict[str, CycleArithmetic]:
    """Return the worst-case cycle of every segment."""
    cycle = settings.rig.cycle
    schedules = {}
    for segment, table in settings.segment.items():
        frames: dict[str, list[PlannedFrame]] = {"TPDO": [], "RPDO": [], "event": []}
        for name, axis in settings.rig.axis.items():
            if axis.segment != segment:
                continue
            for telegram in axis_telegrams(settings, name).values():
                kind = telegram.name[:4] if telegram.is_cyclic else "event"
                frames[kind].append(
                    PlannedFrame(
                        f"{name}.{telegram.name}", telegram.cob_id(axis.node), telegram.length
                    )
                )
        schedules[segment] = cycle_arithmetic(
            table.bitrate,
            cycle.period_us * US,
            cycle.cycle_offset_us * US,
            frames["TPDO"],
            frames["RPDO"],
            frames["event"],
        )
    return schedules


def axis_steps(settings: Settings, name: str) -> tuple[Step, ...]:
    """Return the steps that start the drive of one axis.

    Raises UserError for what the drive cannot do by its EDS.
    """
    rig = settings.rig
    axis = rig.axis[name]
    bus = BusSettings(
        sync_period_us=rig.cycle.period_us,
        sync_counter=rig.cycle.sync_counter,
        heartbeat_ms=rig.cycle.heartbeat_ms,
        master_node=rig.cycle.master_node,
    )
    keys = rig.drive[axis.drive]
    return drive_steps(keys, bus, axis_telegrams(settings, name), axis.node, keys.make())


def _check_start_up(settings: Settings) -> None:
    """Check what the kernel tells the drives against what they have."""
    for name, axis in settings.rig.axis.items():
        try:
            axis_steps(settings, name)
        except UserError as error:
            if error.file is not None:
                raise
            raise rig_error(
                settings.files,
                ("drive", axis.drive),
                f"drive {axis.drive} of axis {name}: {error.message}",
                value=error.value,
                allowed=error.allowed,
                hint=error.hint,
            ) from error


def check_rig(settings: Settings) -> None:
    """Check references, node ids, measuring source and bus time.

    Raises UserError with file, line and key of the rig.
    """
    _check_references(settings)
    _check_nodes(settings)
    _check_names(settings)
    _check_drives(settings)
    _check_start_up(settings)
    cycle = settings.rig.cycle
    if cycle.cycle_offset_us >= cycle.period_us:
        raise rig_error(
            settings.files,
            ("cycle", "cycle_offset_us"),
            "the NC cycle must lie inside the period",
            value=cycle.cycle_offset_us,
            allowed=f"0 .. {cycle.period_us - 1} us",
        )
    for segment, schedule in segment_schedules(settings).items():
        if not schedule.fits:
            raise rig_error(
                settings.files,
                ("segment", segment),
                f"the cycle does not fit on segment {segment} in the worst case:\n"
                f"{schedule.table()}\n",
                hint="use another segment, a longer period_us or another cycle_offset_us",
            )


def _check_references(settings: Settings) -> None:
    rig, files = settings.rig, settings.files
    if not rig.axis:
        raise rig_error(files, ("axis",), "the rig has no axis")
    for name, axis in rig.axis.items():
        wanted: list[tuple[str, str, Mapping[str, object]]] = [
            ("segment", axis.segment, rig.segment),
            ("drive", axis.drive, rig.drive),
            ("plant", axis.plant, rig.plant),
        ]
        wanted += [
            (key, probe, rig.plant)
            for key, probe in (("probe_1", axis.probe_1), ("probe_2", axis.probe_2))
            if probe is not None
        ]
        for key, value, known in wanted:
            if value not in known:
                raise rig_error(
                    files,
                    ("axis", name, key),
                    f"axis {name}: {key} names nothing in this rig",
                    value=value,
                    allowed=known,
                )


def _check_drives(settings: Settings) -> None:
    for name, drive in settings.rig.drive.items():
        try:
            drive.make()
        except UserError as error:
            raise rig_error(
                settings.files,
                ("drive", name),
                error.message,
                value=error.value,
                allowed=error.allowed,
            ) from error


def _check_nodes(settings: Settings) -> None:
    seen: dict[tuple[str, int], str] = {}
    for name, axis in settings.rig.axis.items():
        other = seen.setdefault((axis.segment, axis.node), name)
        if other != name:
            raise rig_error(
                settings.files,
                ("axis", name, "node"),
                f"axes {other} and {name} have the same node id on segment {axis.segment}",
                value=axis.node,
            )
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
                allowed="one of A B C U V W X Y Z, or such a letter with digits",
            )
        listed = settings.axis[name].word("kopf.log_achs_name")
        if listed and listed != name:
            raise UserError(
                f"the list belongs to axis {listed}, the rig uses it for axis {name}",
                file=axis.list,
                value=listed,
                allowed=name,
            )
