"""What the control counts with, to be held against the parameters of a PROFIdrive drive."""

from axisrig.bench.rig.profidrive.checks import (
    ABSOLUTE,
    BASE,
    FINE,
    NOT_SET,
    XIST1,
    measures,
)
from axisrig.bench.rig.profidrive.members import drive_of
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.drives.profidrive.startup import Expected
from axisrig.kernel.profiles.profidrive.words import PROBE_AT_INPUT


def expected_parameters(settings: Settings, name: str) -> tuple[Expected, ...]:
    """Return what the drive of an axis has to have at its start; empty without `parameter_check`.

    P-AXIS-00316 counts before 00065 where it is set; P-AXIS-00317 where it is set.
    """
    table, parameters = drive_of(settings, name), settings.axis[name]
    if not table.parameter_check:
        return ()
    fine, own, absolute = (parameters.integer(path) for path in (FINE, XIST1, ABSOLUTE))
    found = [
        Expected(922, table.make().telegram.number, "telegram of the rig"),
        Expected(880, parameters.integer(BASE), "P-AXIS-00379"),
        Expected(1042, fine, "P-AXIS-00065")
        if own == NOT_SET
        else Expected(1042, own, "P-AXIS-00316"),
    ]
    if absolute != NOT_SET:
        found.append(Expected(1043, absolute, "P-AXIS-00317"))
    if measures(settings, name):
        found.append(Expected(660, PROBE_AT_INPUT, "the probe of the drive, P-AXIS-00516"))
    return tuple(found)
