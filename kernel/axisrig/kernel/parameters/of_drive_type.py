"""What the drive type of an axis (P-AXIS-00020) makes of its list: corrected, with a warning.

What each type has is `drive_types.csv`. Sources: the pages of the warnings in `errors.csv`, FCT-C4
section 8.2.
"""

from collections.abc import Iterator
from typing import Final

from axisrig.kernel.errors import Alarm
from axisrig.kernel.parameters.drive_types import DEFAULT_MODE, DriveType
from axisrig.kernel.parameters.origin import Origin
from axisrig.kernel.parameters.signal_sources import SOURCES
from axisrig.kernel.parameters.types import written
from axisrig.kernel.parameters.values import ParameterSet

SIGNAL, INPUT, EDGE = "kenngr.measure.signal", "kenngr.measure.input", "kenngr.measure.edge"
MEASURES, OPERATION_MODE = "kenngr.messachse", "antr.operation_mode"
_OLDER_SWITCHES: Final = {
    "00115": "kenngr.mess_signal_achs_steuer",
    "00116": "kenngr.mess_signal_sercos",
    "00117": "kenngr.mess_signal_taster",
}
_LAG_LIMIT, _LAG_LIMIT_NUMBER = "kenngr.measure.fixed_stop_detect.pos_lag_limit", "00774"
_FUNCTION: Final = "antr.function["


def of_drive_type(parameters: ParameterSet, axis: str, kind: DriveType) -> Iterator[Alarm]:
    """Correct what a drive of a type does not have, and yield the warning of each correction.

    Raises UserError for an edge that it does not latch, for which no ID is documented.
    """
    on, drive = "lr_param.distance_control_on", kind.name
    if parameters.flag(on) and not kind.distance_control:
        parameters.correct(on, False)
        yield Alarm(110547, axis=axis, drive_type=drive)
    yield from _older_switches(parameters, axis, kind)
    signal = parameters.word(SIGNAL)
    if parameters.is_set(SIGNAL) and not kind.offers(signal):
        parameters.correct(SIGNAL, "PLC")
        yield Alarm(110586, axis=axis, drive_type=drive, wrong=signal, corrected="PLC")
    yield from _inputs(parameters, axis, kind)
    edge_banding = "kenngr.measure.input_edge_banding"
    wrong = _own(parameters, edge_banding)
    if wrong and not kind.edge_banding:
        parameters.correct(edge_banding, 0)
        yield Alarm(110614, axis=axis, drive_type=drive, wrong=wrong)
    _check_edge(parameters, kind)
    if (
        kind.fixed_stop
        and _LAG_LIMIT_NUMBER not in kind.fixed_stop
        and parameters.is_set(_LAG_LIMIT)
    ):
        number = parameters.integer(_LAG_LIMIT)
        parameters.correct(_LAG_LIMIT, -1)
        yield Alarm(900741, axis=axis, drive_type=drive, value=number)
    yield from _operation_mode(parameters, axis, kind)
    functions = [name for name, _ in parameters.items() if name.startswith(_FUNCTION)]
    if functions and not kind.access:
        yield Alarm(900742, axis=axis, drive_type=drive, names=", ".join(functions))


def _older_switches(parameters: ParameterSet, axis: str, kind: DriveType) -> Iterator[Alarm]:
    """Clear switches of the older probing signals that the type does not have."""
    for number, path in _OLDER_SWITCHES.items():
        if number not in kind.older_switches and parameters.flag(path):
            parameters.correct(path, False)
            yield Alarm(900740, axis=axis, drive_type=kind.name, number=f"P-AXIS-{number}")


def _inputs(parameters: ParameterSet, axis: str, kind: DriveType) -> Iterator[Alarm]:
    """Correct probing inputs that the drive does not have."""
    signal = parameters.word(SIGNAL)
    most, wrong = kind.inputs_of(signal), parameters.integer(INPUT)
    if SOURCES[signal].latched == "drive" and most is not None and wrong > most:
        parameters.correct(INPUT, 1)
        yield Alarm(110622, axis=axis, probe=0, wrong=wrong, corrected=1)
    for probe in (0, 1):
        path = f"kenngr.measure.probe[{probe}].input"
        wrong = _own(parameters, path)
        if not 0 <= wrong <= kind.inputs:
            parameters.correct(path, 0)  # so that its fallback decides
            corrected = parameters.integer(path)
            yield Alarm(110622, axis=axis, probe=probe, wrong=wrong, corrected=corrected)


def _check_edge(parameters: ParameterSet, kind: DriveType) -> None:
    found = parameters.resolve(EDGE)
    edge, signal = parameters.word(EDGE), parameters.word(SIGNAL)
    if SOURCES[signal].latched != "drive" or not kind.latch or edge in kind.edges:
        return
    place = found.origin or Origin(EDGE)
    raise place.error(
        f"a drive of the type {kind.name} does not latch at this edge (P-AXIS-00518)",
        value=written(found.value),
        allowed=" ".join(kind.edges),
    )


def _operation_mode(parameters: ParameterSet, axis: str, kind: DriveType) -> Iterator[Alarm]:
    """Correct a place of the position loop that the type, or an axis, does not have."""
    wrong = parameters.word(OPERATION_MODE)
    if wrong.startswith("OPEN_"):
        parameters.correct(OPERATION_MODE, DEFAULT_MODE)
        axis_type = parameters.word("kenngr.achs_typ")
        yield Alarm(110511, axis=axis, drive_type=kind.name, wrong=wrong, axis_type=axis_type,
                    corrected=DEFAULT_MODE)  # fmt: skip
    elif wrong not in kind.modes:
        parameters.correct(OPERATION_MODE, DEFAULT_MODE)
        yield Alarm(110457, axis=axis, drive_type=kind.name, wrong=wrong, corrected=DEFAULT_MODE)


def _own(parameters: ParameterSet, path: str) -> int:
    """Return what was set for a number whose unset value is 0, without its fallback."""
    found = parameters.resolve(path)
    return int(found.value) if found.key == path else 0
