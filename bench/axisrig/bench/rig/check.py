"""Checks of a rig after its form: how parts are wired, and whether the cycle fits on the bus."""

import re
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path

from axisrig.bench.bus.can.arithmetic import SYNC, CycleArithmetic, PlannedFrame, cycle_arithmetic
from axisrig.bench.drive.cia402.dictionary.profiles import DEFAULT_PROFILE
from axisrig.bench.rig.cause import blamed
from axisrig.bench.rig.io_node import check_terminal, terminal_frames
from axisrig.bench.rig.reading.file import LOAD, DriveTable, rig_error
from axisrig.bench.rig.reading.lists import check_drive_types, check_numbers, drive_input
from axisrig.bench.rig.reading.startup import drive_dictionary, drive_steps
from axisrig.bench.rig.real_axes import check_outside, is_real
from axisrig.bench.rig.settings import Settings, once
from axisrig.kernel.drives.canopen.dictionary import check_functions, variable
from axisrig.kernel.drives.canopen.functions import read_functions
from axisrig.kernel.drives.canopen.mapping import FROM_LATCH_TO_COUNTER, Telegram, telegrams
from axisrig.kernel.drives.canopen.startup_steps import BusSettings, Step
from axisrig.kernel.drives.canopen.words import latch_object
from axisrig.kernel.errors import UserError
from axisrig.kernel.profiles.canopen.identifiers import (
    EMERGENCY_BASE,
    ERROR_CONTROL_BASE,
    SDO_ANSWER_BASE,
    SDO_REQUEST_BASE,
)
from axisrig.kernel.time.clock import US

# COB-IDs of the pre-defined connection set (CiA 301) to which the node id is added
Rare = tuple[str, int]
_EMCY: Rare = ("EMCY", EMERGENCY_BASE)
SDO_FRAMES: tuple[Rare, Rare] = (("SDO answer", SDO_ANSWER_BASE), ("SDO request", SDO_REQUEST_BASE))

DIGITAL_INPUTS = 0x60FD
TRIGGER_SOURCE = "antr.canopen.probing_trigger_source"

# The letters of addresses that NC programs give to axes (F, G, M, N, S, T, D mean other things)
_AXIS_NAME = re.compile(r"[ABCUVWXYZ][0-9]{0,3}")


def latch_object_of(settings: Settings, name: str) -> int:
    """Return the latch object (60BA to 60BD) of input and edge that an axis measures with."""
    parameters = settings.axis[name]
    return latch_object(drive_input(parameters), parameters.word("kenngr.measure.edge"))


def _drive_of(settings: Settings, name: str) -> DriveTable:
    return settings.rig.drive[settings.rig.axis[name].drive]


def _has_object(settings: Settings, name: str, index: int) -> bool:
    """Whether the drive of an axis has an object for a TPDO, by its EDS if the rig names one."""
    drive = _drive_of(settings, name)
    if drive.eds is None:
        return drive.make().has_object(index)
    found = variable(drive_dictionary(drive, settings.rig.axis[name].node, drive.make()), index, 0)
    return found is not None and bool(found.pdo_mappable)


def _knows_counter(settings: Settings, name: str) -> bool:
    return _has_object(settings, name, latch_object_of(settings, name) + FROM_LATCH_TO_COUNTER)


@once
def has_latch_counter(settings: Settings, name: str) -> bool:
    """Whether the counter of the latch is in the same telegram as the latch.

    It does where the drives have it and the cycle still fits on the bus with the counters of all
    drives of the segment.
    """
    segment = settings.rig.axis[name].segment
    return _knows_counter(settings, name) and schedule_of(settings, segment, counters=True).fits


def has_inputs(settings: Settings, name: str) -> bool:
    """Whether the drive of an axis has the digital inputs 60FD."""
    return _has_object(settings, name, DIGITAL_INPUTS)


def has_second(settings: Settings, name: str) -> bool:
    """Whether the kernel's own telegrams carry the second encoder of an axis.

    They do where the axis has one and its distance control is released (P-AXIS-00328).
    """
    released = settings.axis[name].flag("lr_param.distance_control_on")
    return released and settings.rig.axis[name].encoder_2 is not None


def axis_telegrams(settings: Settings, name: str) -> dict[str, Telegram]:
    """Return the PDOs of one axis; the latch object follows from input and edge."""
    return _telegrams(settings, name, counter=has_latch_counter(settings, name))


def _telegrams(settings: Settings, name: str, *, counter: bool) -> dict[str, Telegram]:
    return telegrams(
        latch_object_of(settings, name),
        _drive_of(settings, name).pdo_map,
        counter=counter,
        inputs=has_inputs(settings, name),
        second=has_second(settings, name),
    )


def segment_schedules(settings: Settings, *, with_rare: bool = False) -> dict[str, CycleArithmetic]:
    """Return the worst-case cycle of every segment, with the counters of latches if they fit.

    with_rare: also with what a healthy cycle does not carry, one EMCY and one SDO transfer for each
    drive. The others, heartbeat and guarding where they are configured, are always reckoned with.
    """
    return {
        segment: schedule_of(
            settings,
            segment,
            counters=schedule_of(settings, segment, counters=True).fits,
            rare=(_EMCY, *SDO_FRAMES) if with_rare else (),
        )
        for segment in settings.segment
    }


@once
def schedule_of(
    settings: Settings, segment: str, *, counters: bool, rare: Sequence[Rare] = ()
) -> CycleArithmetic:
    """Return the worst-case cycle of a segment, with the counters of latches if asked for.

    rare: what each drive may send, or be sent, besides.
    """
    cycle = settings.rig.cycle
    frames: dict[str, list[PlannedFrame]] = {"TPDO": [], "RPDO": [], "event": []}
    if cycle.heartbeat_ms:
        frames["event"].append(PlannedFrame("heartbeat", ERROR_CONTROL_BASE + cycle.master_node, 1))
    for name, axis in settings.rig.axis.items():
        if axis.segment != segment:
            continue
        counter = counters and _knows_counter(settings, name)
        for telegram in _telegrams(settings, name, counter=counter).values():
            kind = telegram.name[:4] if telegram.is_cyclic else "event"
            frames[kind].append(
                PlannedFrame(f"{name}.{telegram.name}", telegram.cob_id(axis.node), telegram.length)
            )
        frames["event"] += _event_frames(settings, name, rare)
    sdo = [(what, base) for what, base in rare if (what, base) != _EMCY]
    for kind, frame in terminal_frames(settings, segment, sdo):
        frames[kind].append(frame)
    return cycle_arithmetic(
        settings.segment[segment].bitrate,
        cycle.period_us * US,
        cycle.cycle_offset_us * US,
        frames["TPDO"],
        frames["RPDO"],
        frames["event"],
        PlannedFrame(SYNC.name, SYNC.can_id, 1 if cycle.sync_counter else 0),
    )


def _event_frames(settings: Settings, name: str, rare: Sequence[Rare]) -> list[PlannedFrame]:
    """Return the frames besides PDOs that the drive of an axis may send, or be sent."""
    axis = settings.rig.axis[name]
    drive, node = settings.rig.drive[axis.drive], axis.node
    frames = []
    if drive.heartbeat_ms:
        frames.append(PlannedFrame(f"{name}.heartbeat", ERROR_CONTROL_BASE + node, 1))
    if drive.guard_time_ms:
        frames.append(PlannedFrame(f"{name}.guarding", ERROR_CONTROL_BASE + node, 0))
        frames.append(PlannedFrame(f"{name}.guarded", ERROR_CONTROL_BASE + node, 1))
    frames += [PlannedFrame(f"{name}.{what}", base + node, 8) for what, base in rare]
    return frames


def describe_schedules(settings: Settings) -> list[str]:
    """Show the arithmetic of every segment, and what rare frames would make of it."""
    rare = segment_schedules(settings, with_rare=True)
    texts = []
    for name, schedule in segment_schedules(settings).items():
        worst = rare[name]
        texts.append(
            f"segment {name}, {schedule.bitrate} bit/s, worst case of one cycle\n"
            f"{schedule.table()}\n"
            f"with EMCY and SDO as well: last TPDO {worst.last_tpdo_ns / US:.1f} us,"
            f" last RPDO {worst.last_rpdo_ns / US:.1f} us"
        )
    return texts


@once
def overloads(settings: Settings) -> dict[str, str]:
    """Return the segments whose cycle does not fit, with what is late in one line."""
    return {
        name: "; ".join(
            f"{what} {time_ns / US:.1f} of {limit_ns / US:.1f} us"
            for what, time_ns, limit_ns in (
                ("last TPDO", schedule.last_tpdo_ns, schedule.cycle_offset_ns),
                ("last RPDO", schedule.last_rpdo_ns, schedule.rpdo_limit_ns),
                ("cyclic frames", schedule.busy_ns, schedule.cycle_ns),
            )
            if time_ns > limit_ns
        )
        for name, schedule in segment_schedules(settings).items()
        if not schedule.fits
    }


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
    return drive_steps(
        keys,
        bus,
        axis_telegrams(settings, name),
        axis.node,
        keys.make(),
        is_real=is_real(settings, axis.segment),
    )


def _check_start_up(settings: Settings) -> None:
    """Check what the kernel sends to the drives against what they have."""
    for name, axis in settings.rig.axis.items():
        try:
            axis_steps(settings, name)
        except UserError as error:
            if error.file is not None:
                raise
            raise rig_error(
                settings.files,
                ("drive", axis.drive),
                f"drive {axis.drive} of axis {name}{_of_profile(settings, name)}: {error.message}",
                value=error.value,
                allowed=error.allowed,
                hint=error.hint,
            ) from error


def _of_profile(settings: Settings, name: str) -> str:
    """Name the profile that says what the drive of an axis has, where the rig names one."""
    drive = _drive_of(settings, name)
    return (
        f" (profile {drive.profile})"
        if drive.profile != DEFAULT_PROFILE and drive.eds is None
        else ""
    )


def _check_functions(settings: Settings) -> None:
    """Check the drive functions of every axis against its drive and its telegrams."""
    for name, axis in settings.rig.axis.items():
        keys = settings.rig.drive[axis.drive]
        od = drive_dictionary(keys, axis.node, keys.make())
        try:
            functions, _ = read_functions(name, settings.axis[name])
            check_functions(name, functions, od, axis_telegrams(settings, name))
        except UserError as error:
            raise rig_error(
                settings.files,
                ("axis", name, "list"),
                error.message,
                value=error.value,
                allowed=error.allowed,
                hint=error.hint,
            ) from error


def check_rig(settings: Settings) -> None:
    """Check references, node ids, measuring source and bus time.

    Raises UserError with file, line and key of the rig; with the place of the cell or `--set`
    where the rig would do without it.
    """
    try:
        _check_rig(settings)
    except UserError as error:
        raise blamed(error, settings, _check_rig) from error


def _check_rig(settings: Settings) -> None:
    _check_references(settings)
    _check_nodes(settings)
    _check_names(settings)
    check_numbers(settings.axis)
    check_drive_types(settings.rig, settings.axis)
    check_outside(settings)
    _check_drives(settings)
    _check_latches(settings)
    _check_start_up(settings)
    _check_functions(settings)
    cycle = settings.rig.cycle
    if cycle.cycle_offset_us >= cycle.period_us:
        raise rig_error(
            settings.files,
            ("cycle", "cycle_offset_us"),
            "the NC cycle must start within the period",
            value=cycle.cycle_offset_us,
            allowed=f"0 .. {cycle.period_us - 1} us",
        )
    for segment, schedule in segment_schedules(settings).items():
        if not schedule.fits and settings.segment[segment].overload == "refuse":
            raise rig_error(
                settings.files,
                ("segment", segment),
                f"the cycle does not fit on segment {segment} in the worst case:\n"
                f"{schedule.table()}\n",
                hint="use another segment, a longer period_us or another cycle_offset_us;"
                " --force runs it all the same and reports the overload",
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
        wanted += [(key, probe, rig.plant) for key, probe in axis.signals.items()]
        if axis.encoder_2 not in (None, LOAD):
            wanted.append(("encoder_2", axis.encoder_2, rig.plant))
        for key, value, known in wanted:
            if value not in known:
                raise rig_error(
                    files,
                    ("axis", name, key),
                    f"axis {name}: {key} names nothing in this rig",
                    value=value,
                    allowed=known,
                )
    task = rig.plc_task
    if task is not None and not Path(task.program).is_file():
        raise rig_error(files, ("plc", "program"), "the PLC program is no file", value=task.program)
    check_terminal(settings)
    for name, table in rig.plc.items():
        if table.sensor not in rig.plant:
            raise rig_error(
                files,
                ("plc", name),
                f"{name}: sensor names nothing in this rig",
                value=table.sensor,
                allowed=rig.plant,
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


def _check_latches(settings: Settings) -> None:
    """Refuse an encoder or a trigger source that the drive of an axis does not have."""
    for name, axis in settings.rig.axis.items():
        parameters, profile = settings.axis[name], settings.rig.drive[axis.drive].make()
        if profile.latch_encoder == "second" and axis.encoder_2 is None:
            raise rig_error(
                settings.files,
                ("drive", axis.drive, "latch_encoder"),
                f"drive {axis.drive} latches its second encoder and axis {name} has none",
                value=profile.latch_encoder,
                hint='give the axis one: encoder_2 = "load", or a distance sensor',
            )
        number = drive_input(parameters)
        is_drive_defined = parameters.word(TRIGGER_SOURCE) == "DRIVE_DEFINED"
        has_source = profile.source_bits == "ignored" or profile.has_object(0x60D0, number)
        if is_drive_defined and not has_source:
            raise rig_error(
                settings.files,
                ("axis", name, "drive"),
                f"axis {name}: {TRIGGER_SOURCE} (P-AXIS-00702) asks for object 60D0:{number} and"
                " the drive does not have it",
                value="DRIVE_DEFINED",
                allowed="CNC_DEFINED",
            )


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
