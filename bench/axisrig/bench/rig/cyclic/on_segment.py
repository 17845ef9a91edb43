"""What a family of drives is on a cyclic segment: checks, what `axisrig check` shows."""

from collections.abc import Callable
from typing import NamedTuple

from axisrig.bench.rig.conventional.checks import check_conventional, describe_conventional
from axisrig.bench.rig.encoder_terminal.checks import (
    check_encoder_terminal,
    describe_encoder_terminal,
)
from axisrig.bench.rig.lightbus.checks import check_lightbus, describe_lightbus
from axisrig.bench.rig.profidrive.checks import check_profidrive, describe_profidrive
from axisrig.bench.rig.profidrive.members import second_of
from axisrig.bench.rig.settings import Settings
from axisrig.bench.rig.speed_drive.members import no_second
from axisrig.kernel.time.clock import TimeNs


class OnSegment(NamedTuple):
    """What a family is there; each gets the settings and the name of an axis.

    check, describe: get the time from the sample of a position to the set value that is made of it
    too; check raises UserError. second: what brings the second encoder, empty where nothing does.
    """

    check: Callable[[Settings, str, TimeNs], None]
    describe: Callable[[Settings, str, TimeNs], list[str]]
    second: Callable[[Settings, str], str]


OF_FAMILY = {
    "profidrive": OnSegment(check_profidrive, describe_profidrive, second_of),
    "lightbus": OnSegment(check_lightbus, describe_lightbus, no_second),
    "conventional": OnSegment(check_conventional, describe_conventional, no_second),
    "encoder_terminal": OnSegment(check_encoder_terminal, describe_encoder_terminal, no_second),
}


def on_segment(settings: Settings, name: str) -> OnSegment:
    """Return what the family of the drive of an axis is on a segment."""
    return OF_FAMILY[settings.rig.drive[settings.rig.axis[name].drive].family_name]
