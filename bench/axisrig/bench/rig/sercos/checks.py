"""Checks of the SERCOS axes of a rig: telegrams, what measuring needs, scaling."""

from axisrig.bench.rig.describe import unproved_place
from axisrig.bench.rig.reading.file import rig_error
from axisrig.bench.rig.reading.lists import drive_input
from axisrig.bench.rig.sercos.keys import carried
from axisrig.bench.rig.sercos.members import drive_of
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.parameters.signal_sources import SOURCES
from axisrig.kernel.profiles.sercos.service import ident_name, ident_number
from axisrig.kernel.profiles.sercos.words import PROBES, STATUS_BITS, telegram_idents

NEEDED = {"at": "S-0-0051", "mdt": "S-0-0047"}
PERIODS_US = (500, *range(1000, 9000, 1000))


def check_sercos(settings: Settings, name: str) -> None:
    """Check one axis. Raises UserError with file, line and key of the rig."""
    axis, table = settings.rig.axis[name], drive_of(settings, name)
    for key, needed in NEEDED.items():
        names = getattr(table, key)
        for ident in names:
            if not carried(ident, key):
                raise rig_error(
                    settings.files,
                    ("drive", axis.drive, key),
                    f"drive {axis.drive} of axis {name}: the {key.upper()} cannot carry this ident",
                    value=ident,
                    allowed=[ident_name(r.ident) for r in telegram_idents().values()
                             if r.telegram == key],
                )  # fmt: skip
        if len(set(names)) != len(names) or needed not in names:
            raise rig_error(
                settings.files,
                ("drive", axis.drive, key),
                f"drive {axis.drive} of axis {name}: the {key.upper()} needs {needed}, and each"
                " ident once",
                value=" ".join(names),
            )
    period_us = settings.rig.cycle.period_us
    if period_us not in PERIODS_US:
        raise rig_error(
            settings.files,
            ("cycle", "period_us"),
            f"axis {name} has a SERCOS drive, and its cycle time S-0-0002 is 500 us or whole ms",
            value=period_us,
            allowed=PERIODS_US,
        )
    if measures(settings, name):
        _check_latch(settings, name)


def measures(settings: Settings, name: str) -> bool:
    """Whether an axis measures with the latch of its drive."""
    parameters = settings.axis[name]
    signal = parameters.word("kenngr.measure.signal")
    return parameters.flag("kenngr.messachse") and SOURCES[signal].latched == "drive"


def latch_of(settings: Settings, name: str) -> tuple[int, str]:
    """Return probing input and edge (P-AXIS-00517, 00518).

    Where the list says neither, those of the last measured value in the AT.
    """
    parameters = settings.axis[name]
    paths = ("kenngr.measure.input", "kenngr.measure.edge")
    if not any(parameters.is_set(path) for path in paths):
        by_value = {idents.value: probe for probe, idents in PROBES.items()}
        listed = [by_value.get(ident_number(ident)) for ident in drive_of(settings, name).at]
        found = [probe for probe in listed if probe is not None]
        if found:
            return found[-1]
    return drive_input(parameters), parameters.word("kenngr.measure.edge")


def _check_latch(settings: Settings, name: str) -> None:
    """Refuse an AT without the measured value of the input and edge in use."""
    axis, table = settings.rig.axis[name], drive_of(settings, name)
    probe, edge = latch_of(settings, name)
    value = PROBES[probe, edge].value
    if value not in [ident_number(ident) for ident in table.at]:
        raise rig_error(
            settings.files,
            ("drive", axis.drive, "at"),
            f"axis {name} measures with input {probe} and edge {edge}, and the AT of drive"
            f" {axis.drive} does not carry {ident_name(value)}",
            value=" ".join(table.at),
            hint=f"add {ident_name(value)}, or set P-AXIS-00118 to 0",
        )


def describe_sercos(settings: Settings, name: str) -> list[str]:
    """Say what the telegrams carry, and how a latch is proved."""
    table = drive_of(settings, name)
    lines = [f"axis {name}: MDT {' '.join(table.mdt)}; AT {' '.join(table.at)}"]
    if not table.position_check:
        lines.append(unproved_place(settings, name))
    if not measures(settings, name):
        return lines
    probe, edge = latch_of(settings, name)
    idents = PROBES[probe, edge]
    lines.append(
        f"axis {name}: measures with input {probe}, edge {edge}: {ident_name(idents.value)}"
        + ("; the service channel proves it" if table.latch_check else "; nothing proves it")
    )
    allocated = {ident for ident, value in table.start_list if value == idents.level}
    if not allocated & set(STATUS_BITS):
        lines.append(
            f"warning: axis {name}: no real-time bit has {ident_name(idents.level)}: whether the"
            " probe is actuated before a run is not known (50052 cannot come)"
        )
    return lines
