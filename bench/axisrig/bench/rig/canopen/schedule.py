"""The cyclic telegrams of CANopen axes, and whether the cycle of a segment fits on its bus."""

from collections.abc import Sequence

from canopen.objectdictionary import ObjectDictionary

from axisrig.bench.bus.can.arithmetic import SYNC, CycleArithmetic, PlannedFrame, cycle_arithmetic
from axisrig.bench.rig.canopen.io_node import terminal_frames
from axisrig.bench.rig.canopen.members import can_segments, drive_of, segment_of
from axisrig.bench.rig.canopen.startup import drive_dictionary
from axisrig.bench.rig.reading.lists import drive_input
from axisrig.bench.rig.settings import Settings, once
from axisrig.kernel.drives.canopen.dictionary import variable
from axisrig.kernel.drives.canopen.mapping import FROM_LATCH_TO_COUNTER, Telegram, telegrams
from axisrig.kernel.drives.canopen.startup_steps import CSV, TPDO_PARAMETERS
from axisrig.kernel.drives.cia402.words import latch_object
from axisrig.kernel.profiles.canopen.identifiers import (
    EMERGENCY_BASE,
    ERROR_CONTROL_BASE,
    ID_MASK,
    MAPPING_OF_PDO,
    NOT_VALID,
    SDO_ANSWER_BASE,
    SDO_REQUEST_BASE,
)
from axisrig.kernel.time.clock import US

# COB-IDs of the pre-defined connection set (CiA 301) to which the node id is added
Rare = tuple[str, int]
_EMCY: Rare = ("EMCY", EMERGENCY_BASE)
SDO_FRAMES: tuple[Rare, Rare] = (("SDO answer", SDO_ANSWER_BASE), ("SDO request", SDO_REQUEST_BASE))

DIGITAL_INPUTS, TOUCH_PROBE = 0x60FD, 0x60B8
SYNC_LAST = 240
"""The last transmission type of a TPDO that comes with SYNC (CiA 301)."""


def latch_object_of(settings: Settings, name: str) -> int:
    """Return the latch object (60BA to 60BD) of input and edge that an axis measures with."""
    parameters = settings.axis[name]
    return latch_object(drive_input(parameters), parameters.word("kenngr.measure.edge"))


def _has_object(settings: Settings, name: str, index: int) -> bool:
    """Whether the drive of an axis has an object for a TPDO, by its EDS if the rig names one."""
    drive = drive_of(settings, name)
    if drive.eds is None:
        return drive.make().has_object(index)
    found = variable(
        drive_dictionary(drive, settings.rig.axis[name].node_id, drive.make()), index, 0
    )
    return found is not None and bool(found.pdo_mappable)


def knows_counter(settings: Settings, name: str) -> bool:
    """Whether the drive of an axis has the counter of its latch."""
    return _has_object(settings, name, latch_object_of(settings, name) + FROM_LATCH_TO_COUNTER)


@once
def has_latch_counter(settings: Settings, name: str) -> bool:
    """Whether the counter of the latch is in the same telegram as the latch.

    It does where the drives have it and the cycle still fits on the bus with the counters of all
    drives of the segment.
    """
    segment = settings.rig.axis[name].segment
    return knows_counter(settings, name) and schedule_of(settings, segment, counters=True).fits


def has_inputs(settings: Settings, name: str) -> bool:
    """Whether the drive of an axis has the digital inputs 60FD."""
    return _has_object(settings, name, DIGITAL_INPUTS)


def has_touch_probe(settings: Settings, name: str) -> bool:
    """Whether the drive of an axis has a touch probe (60B8), by its EDS if the rig names one."""
    drive = drive_of(settings, name)
    if drive.eds is None:
        return drive.make().has_object(TOUCH_PROBE)
    od = drive_dictionary(drive, settings.rig.axis[name].node_id, drive.make())
    return variable(od, TOUCH_PROBE, 0) is not None


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
        drive_of(settings, name).pdo_map,
        counter=counter,
        inputs=has_inputs(settings, name),
        second=has_second(settings, name),
        speed=drive_of(settings, name).mode == CSV,
        probe=has_touch_probe(settings, name),
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
        for segment in can_segments(settings)
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
        counter = counters and knows_counter(settings, name)
        for telegram in _telegrams(settings, name, counter=counter).values():
            kind = telegram.name[:4] if telegram.is_cyclic else "event"
            frames[kind].append(
                PlannedFrame(
                    f"{name}.{telegram.name}", telegram.cob_id(axis.node_id), telegram.length
                )
            )
        for kind, frame in fixed_frames(settings, name):
            frames[kind].append(frame)
        frames["event"] += _event_frames(settings, name, rare)
    sdo = [(what, base) for what, base in rare if (what, base) != _EMCY]
    for kind, frame in terminal_frames(settings, segment, sdo):
        frames[kind].append(frame)
    return cycle_arithmetic(
        segment_of(settings, segment).bitrate,
        cycle.period_us * US,
        cycle.cycle_offset_us * US,
        frames["TPDO"],
        frames["RPDO"],
        frames["event"],
        PlannedFrame(SYNC.name, SYNC.can_id, 1 if cycle.sync_counter else 0),
    )


def fixed_frames(settings: Settings, name: str) -> list[tuple[str, PlannedFrame]]:
    """Return the TPDOs that a drive sends by its EDS and that the mapping of the rig leaves out.

    They are those that cannot be switched off. With them comes what sends them: "TPDO" with SYNC,
    "event" at another time; the length is that of their default mapping.
    """
    drive, node_id = drive_of(settings, name), settings.rig.axis[name].node_id
    if drive.eds is None:
        return []
    od = drive_dictionary(drive, node_id, drive.make())
    mapped = {t.communication_index for t in _telegrams(settings, name, counter=False).values()}
    found = []
    for index in TPDO_PARAMETERS:
        entry = variable(od, index, 1) if index in od and index not in mapped else None
        cob_id = NOT_VALID if entry is None or entry.writable else entry.default or NOT_VALID
        if cob_id & NOT_VALID:
            continue
        count = _default(od, index + MAPPING_OF_PDO, 0)
        subs = range(1, count + 1)
        bits = sum(_default(od, index + MAPPING_OF_PDO, sub) & 0xFF for sub in subs)
        kind = "TPDO" if _default(od, index, 2) <= SYNC_LAST else "event"
        title = f"{name}.TPDO{index - TPDO_PARAMETERS[0] + 1} (not mapped)"
        found.append((kind, PlannedFrame(title, cob_id & ID_MASK, min(-(-bits // 8), 8))))
    return found


def _default(od: ObjectDictionary, index: int, sub: int) -> int:
    entry = variable(od, index, sub)
    return entry.default if entry is not None and isinstance(entry.default, int) else 0


def _event_frames(settings: Settings, name: str, rare: Sequence[Rare]) -> list[PlannedFrame]:
    """Return the frames besides PDOs that the drive of an axis may send, or be sent."""
    axis = settings.rig.axis[name]
    drive, node = drive_of(settings, name), axis.node_id
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
