"""Checks of the CANopen drives of a rig: node ids, what drives have, whether the cycle fits."""

from collections.abc import Callable, Mapping, Sequence

from axisrig.bench.drive.cia402.dictionary.profiles import DEFAULT_PROFILE
from axisrig.bench.rig.canopen.dcf_words import check_dcf
from axisrig.bench.rig.canopen.io_node import check_terminal
from axisrig.bench.rig.canopen.loop import check_loop
from axisrig.bench.rig.canopen.members import can_axes, drive_of, segment_of
from axisrig.bench.rig.canopen.schedule import axis_telegrams, segment_schedules
from axisrig.bench.rig.canopen.startup import drive_dictionary, drive_steps
from axisrig.bench.rig.reading.file import error_at, rig_error
from axisrig.bench.rig.reading.lists import drive_input
from axisrig.bench.rig.real_axes import is_real
from axisrig.bench.rig.settings import Settings, once
from axisrig.kernel.drives.canopen.dictionary import check_functions
from axisrig.kernel.drives.canopen.mapping import Telegram
from axisrig.kernel.drives.canopen.startup_steps import BusSettings, Step
from axisrig.kernel.drives.functions import read_functions
from axisrig.kernel.errors import UserError

TRIGGER_SOURCE = "antr.canopen.probing_trigger_source"


def check_nodes(settings: Settings) -> None:
    """Refuse a node id that two of a segment have. Raises UserError with the key of the rig."""
    seen: dict[tuple[str, int], str] = {}
    for name in can_axes(settings):
        axis = settings.rig.axis[name]
        other = seen.setdefault((axis.segment, axis.node_id), name)
        if other != name:
            raise rig_error(
                settings.files,
                ("axis", name, "node"),
                f"axes {other} and {name} have the same node id on segment {axis.segment}",
                value=axis.node_id,
            )
    check_terminal(settings)


def check_drives(settings: Settings) -> None:
    """Check what drives have against what is wanted of them, and that each cycle fits on its bus.

    Raises UserError with file, line and key of the rig.
    """
    for name in can_axes(settings):
        check_latch_of(settings, name)
        check_steps_of(settings, name, axis_steps)
        check_loop(settings, name, axis_telegrams(settings, name).values(), late_cycles=0)
        node_id = settings.rig.axis[name].node_id
        check_functions_of(settings, name, node_id, axis_telegrams(settings, name))
    for segment, schedule in segment_schedules(settings).items():
        if not schedule.fits and segment_of(settings, segment).overload == "refuse":
            raise rig_error(
                settings.files,
                ("segment", segment),
                f"the cycle does not fit on segment {segment} in the worst case:\n"
                f"{schedule.table()}\n",
                hint="use another segment, a longer period_us or another cycle_offset_us;"
                " --force runs it all the same and reports the overload",
            )


@once
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
    keys = drive_of(settings, name)
    if keys.eds is not None:
        check_dcf(settings, name, drive_dictionary(keys, axis.node_id, keys.make()))
    return drive_steps(
        keys,
        bus,
        axis_telegrams(settings, name),
        axis.node_id,
        keys.make(),
        is_real=is_real(settings, axis.segment),
    )


def check_steps_of(
    settings: Settings, name: str, make: Callable[[Settings, str], Sequence[object]]
) -> None:
    """Check what the kernel sends to the drive of an axis against what it has. Raises UserError.

    make: the steps that start it.
    """
    axis = settings.rig.axis[name]
    try:
        make(settings, name)
    except UserError as error:
        if error.file is not None:
            raise
        message = f"drive {axis.drive} of axis {name}{_of_profile(settings, name)}: {error.message}"
        raise error_at(settings.files, ("drive", axis.drive), error, message) from error


def _of_profile(settings: Settings, name: str) -> str:
    """Name the profile that says what the drive of an axis has, where the rig names one."""
    drive = drive_of(settings, name)
    return (
        f" (profile {drive.profile})"
        if drive.profile != DEFAULT_PROFILE and drive.eds is None
        else ""
    )


def check_functions_of(
    settings: Settings, name: str, node_id: int, mapped: Mapping[str, Telegram]
) -> None:
    """Check the drive functions of an axis; mapped: its telegrams. Raises UserError."""
    keys = drive_of(settings, name)
    od = drive_dictionary(keys, node_id, keys.make())
    try:
        functions, _ = read_functions(name, settings.axis[name])
        check_functions(name, functions, od, mapped)
    except UserError as error:
        raise error_at(settings.files, ("axis", name, "list"), error) from error


def check_latch_of(settings: Settings, name: str) -> None:
    """Refuse an encoder or a trigger source that the drive of an axis does not have."""
    axis = settings.rig.axis[name]
    parameters, profile = settings.axis[name], drive_of(settings, name).make()
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
