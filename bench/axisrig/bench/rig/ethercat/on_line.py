"""What a family of drives is on a line: telegrams, checks, what `axisrig check` shows."""

from collections.abc import Callable
from typing import NamedTuple

from axisrig.bench.rig.canopen.checks import (
    check_functions_of,
    check_latch_of,
    check_steps_of,
)
from axisrig.bench.rig.canopen.latches import MEASURES, missing_touch_probe
from axisrig.bench.rig.canopen.loop import check_loop, describe_loop
from axisrig.bench.rig.canopen.members import drive_of
from axisrig.bench.rig.describe import WHAT_PASSES, unproved_place
from axisrig.bench.rig.ethercat.members import axis_telegrams, position_of
from axisrig.bench.rig.ethercat.startup import BOOT_ONLY, CAN_ONLY, axis_steps
from axisrig.bench.rig.reading.file import rig_error
from axisrig.bench.rig.sercos.checks import check_sercos, describe_sercos
from axisrig.bench.rig.sercos.members import sercos_pdos
from axisrig.bench.rig.settings import Settings, once
from axisrig.kernel.drives.ethercat.settings import Pdo
from axisrig.kernel.drives.mapped import MappedObject

OUTPUTS, INPUTS = 0x1600, 0x1A00
ENTRIES_MAX = 16
"""Objects in a PDO of our own drive."""


class OnLine(NamedTuple):
    """What a family is on a line; each gets the settings and the name of an axis.

    pdos: of its outputs and of its inputs. check, describe: get the cycles that the line adds too;
    check raises UserError. second: how the position of the second encoder comes.
    """

    pdos: Callable[[Settings, str], tuple[Pdo, Pdo]]
    check: Callable[[Settings, str, int], None]
    describe: Callable[[Settings, str, int], list[str]]
    second: str


def on_line(settings: Settings, name: str) -> OnLine:
    """Return what the family of the drive of an axis is on a line."""
    return OF_FAMILY[settings.rig.drive[settings.rig.axis[name].drive].family_name]


@once
def axis_pdos(settings: Settings, name: str) -> tuple[Pdo, Pdo]:
    """Return the PDO of the outputs and that of the inputs; of SERCOS the MDT and the AT."""
    return on_line(settings, name).pdos(settings, name)


# CiA 402


def _pdos(settings: Settings, name: str) -> tuple[Pdo, Pdo]:
    """Return the objects of all RPDOs in the first PDO, those of all TPDOs in the other.

    A PDO of EtherCAT is not bound to eight bytes.
    """
    sent, taken = list[MappedObject](), list[MappedObject]()
    for telegram in axis_telegrams(settings, name).values():
        (sent if telegram.is_received else taken).extend(telegram.objects)
    return Pdo(OUTPUTS, tuple(sent)), Pdo(INPUTS, tuple(taken))


def _check(settings: Settings, name: str, late_cycles: int) -> None:
    _check_can_keys(settings, name)
    check_latch_of(settings, name)
    check_steps_of(settings, name, axis_steps)
    telegrams = axis_telegrams(settings, name)
    check_loop(settings, name, telegrams.values(), late_cycles)
    check_functions_of(settings, name, position_of(settings, name), telegrams)


def _check_can_keys(settings: Settings, name: str) -> None:
    """Refuse keys of the drive that mean nothing on EtherCAT."""
    axis, drive = settings.rig.axis[name], drive_of(settings, name)
    given = {key: why for key, why in CAN_ONLY.items() if getattr(drive, key)}
    if drive.boot not in BOOT_ONLY:
        given["boot"] = "there is no NMT: the start-up goes through the states of the slave"
    for key, why in given.items():
        raise rig_error(
            settings.files,
            ("drive", axis.drive, key),
            f"drive {axis.drive} of axis {name} is on EtherCAT: {why}",
            value=getattr(drive, key),
            hint=f"leave {key} out, or give the axis a drive of its own",
        )
    for telegram in axis_telegrams(settings, name).values():
        if telegram.is_cyclic and telegram.transmission != 1:
            raise rig_error(
                settings.files,
                ("drive", axis.drive, "pdo_map"),
                f"drive {axis.drive} of axis {name}: {telegram.name} comes with every"
                f" {telegram.transmission}. SYNC only, and the process image carries all values in"
                " each cycle",
                value=telegram.transmission,
                allowed="1, 254, 255",
            )


def _describe(settings: Settings, name: str, late_cycles: int) -> list[str]:
    lines = [*describe_loop(settings, name, late_cycles), *_latches(settings, name)]
    if not drive_of(settings, name).position_check:
        lines.append(unproved_place(settings, name))
    return lines


def _latches(settings: Settings, name: str) -> list[str]:
    """Say how the latches of an axis are proved, and warn where they are not."""
    if not settings.axis[name].flag(MEASURES):
        return []
    if missing := missing_touch_probe(settings, name):
        return missing
    if drive_of(settings, name).latch_check:
        return [f"axis {name}: SDO proves its latches; the mailbox has room in every cycle"]
    drive = settings.rig.axis[name].drive
    return [
        f"warning: axis {name}: its latches are unproved: latch_check of drive {drive} is false;"
        f" {WHAT_PASSES}"
    ]


OF_FAMILY = {
    "canopen": OnLine(_pdos, _check, _describe, "60E4:1, in the process image of each cycle"),
    "sercos": OnLine(
        sercos_pdos,
        lambda settings, name, _: check_sercos(settings, name),
        lambda settings, name, _: describe_sercos(settings, name),
        "S-0-0053, in the AT of each cycle",
    ),
}
"""By the name of the family."""
