"""Checks of the PROFIdrive axes of a rig: fine bits, speed base, telegram, probe."""

from axisrig.bench.oracles.position_loop import ramp_lag_mm
from axisrig.bench.rig.describe import unproved_place
from axisrig.bench.rig.loop import feed_forward, kv_per_s
from axisrig.bench.rig.profidrive.loop import (
    check_loop,
    limit_of,
    period_and_dead,
    uses_dsc,
    wrong_mode,
)
from axisrig.bench.rig.profidrive.members import drive_of
from axisrig.bench.rig.reading.file import error_at
from axisrig.bench.rig.reading.lists import drive_input
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.drives.functions import read_functions
from axisrig.kernel.drives.profidrive.parameter_channel import NUMBERS
from axisrig.kernel.errors import UserError
from axisrig.kernel.parameters import Origin
from axisrig.kernel.parameters.signal_sources import SOURCES
from axisrig.kernel.profiles.profidrive.parameters import parameters as known_parameters
from axisrig.kernel.profiles.profidrive.words import PROBE_AT_INPUT
from axisrig.kernel.time.clock import TimeNs

FINE, XIST1, ABSOLUTE, BASE = (
    f"antr.profibus.{key}"
    for key in ("feinaufloesung", "p1042", "p1043", "drive_velocity_base_value")
)
NOT_SET = -1
SHOWN_MM_S = 10.0


def check_profidrive(settings: Settings, name: str, way_ns: TimeNs) -> None:
    """Check one axis. way_ns: from a sample to what is made of it. Raises UserError."""
    _check_fine_bits(settings, name)
    table, parameters = drive_of(settings, name), settings.axis[name]
    if parameters.integer(BASE) != table.p0880:
        raise (parameters.origin(BASE) or Origin(BASE)).error(
            f"axis {name}: its drive takes NSOLL_B for a share of another speed (p0880 of the rig):"
            f" a factor of {table.p0880 / parameters.integer(BASE):.6g} (P-AXIS-00379)",
            value=parameters.integer(BASE),
            allowed=str(table.p0880),
        )
    if measures(settings, name) and drive_input(parameters) != 1:
        raise (parameters.origin("kenngr.measure.input") or Origin(name)).error(
            f"axis {name}: its drive has one probe at its encoder, I0.x (P-AXIS-00517)",
            value=drive_input(parameters),
            allowed="1",
        )
    try:
        _check_functions(settings, name)
    except UserError as error:
        raise error_at(settings.files, ("axis", name, "list"), error) from error
    if wrong_mode(settings, name) is None:
        check_loop(settings, name, way_ns)


def _check_functions(settings: Settings, name: str) -> None:
    """Refuse drive functions of parameters that the drive does not have, or not so."""
    known = known_parameters()
    functions, _ = read_functions(name, settings.axis[name], NUMBERS)
    for function in functions.values():
        where = f"axis {name}: drive function {function.key}"
        if function.communication == "CYCLIC":
            raise UserError(
                f"{where}: no word of the telegram is known to carry it (P-AXIS-00397)",
                value=function.communication,
                allowed="ACYCLIC, IGNORE",
            )
        for number in (function.index, function.read_index):
            found = known.get(number)
            if found is None:
                raise UserError(
                    f"{where}: the drive has no such parameter (P-AXIS-00398)",
                    value=number,
                    allowed=", ".join(map(str, known)),
                )
            data_type = f"{'SGN' if found.is_signed else 'UNS'}{found.bits:02d}"
            if function.data_type != data_type:
                raise UserError(
                    f"{where}: parameter {number} has another data type (P-AXIS-00399)",
                    value=function.data_type,
                    allowed=data_type,
                )


def _check_fine_bits(settings: Settings, name: str) -> None:
    """Refuse fine bits that are not those of the drive: one bit is a factor of 2."""
    table, parameters = drive_of(settings, name), settings.axis[name]
    for path, number, key in (
        (FINE, "P-AXIS-00065", "p1042"),
        (XIST1, "P-AXIS-00316", "p1042"),
        (ABSOLUTE, "P-AXIS-00317", "p1043"),
    ):
        bits, expected = parameters.integer(path), getattr(table, key)
        if bits in (expected, NOT_SET):
            continue
        raise (parameters.origin(path) or Origin(path)).error(
            f"axis {name}: its drive has other fine bits ({key} of the rig): positions wrong by a"
            f" factor of {2.0 ** (expected - bits):g} ({number})",
            value=bits,
            allowed=str(expected),
        )


def measures(settings: Settings, name: str) -> bool:
    """Whether an axis measures with the latch of its drive."""
    parameters = settings.axis[name]
    signal = parameters.word("kenngr.measure.signal")
    return parameters.flag("kenngr.messachse") and SOURCES[signal].latched == "drive"


def describe_profidrive(settings: Settings, name: str, way_ns: TimeNs) -> list[str]:
    """Say where the loop is closed, and what a latch needs."""
    table, lines = drive_of(settings, name), list[str]()
    wrong = wrong_mode(settings, name)
    if wrong is not None:
        lines.append(f"warning: axis {name}: {wrong}: the control does not start")
    else:
        where = (
            "the drive closes the position loop (DSC)"
            if uses_dsc(settings, name)
            else ("the CNC closes the position loop")
        )
        gain, forward = kv_per_s(settings, name), feed_forward(settings, name)
        period_s, dead = period_and_dead(settings, name, way_ns)
        lines.append(
            f"axis {name}: {where}: Kv {gain:g} 1/s, feed-forward {forward:.6g}, lag"
            f" {ramp_lag_mm(SHOWN_MM_S, gain, forward):.4g} mm at {SHOWN_MM_S:g} mm/s; stable below"
            f" {limit_of(settings, name, way_ns) / period_s:.4g} 1/s with {dead:.4g} dead cycles"
        )
    if not table.proves_places:
        reason = (
            None
            if not table.position_check
            else ("the absolute position has other fine bits (p1043) than G1_XIST1 (p1042)")
        )
        lines.append(unproved_place(settings, name, reason))
    if measures(settings, name) and table.p0660 != PROBE_AT_INPUT:
        lines.append(
            f"warning: axis {name}: p0660 of its drive is {table.p0660} and not {PROBE_AT_INPUT}:"
            " its fast input is that of no probe, and nothing is latched"
        )
    return lines
