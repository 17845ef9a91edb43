"""What the control corrects when it takes over the parameter lists, with its class 1 warnings.

Sources: the pages of the warnings in `errors.csv`, FCT-C4 section 8.2, TF5200 axis parameters.
"""

from collections.abc import Iterator, Mapping

from axisrig.kernel.errors import Alarm, catalogue
from axisrig.kernel.parameters.drive_types import DRIVE_TYPES, DriveType
from axisrig.kernel.parameters.of_drive_type import INPUT, MEASURES, SIGNAL, of_drive_type
from axisrig.kernel.parameters.origin import Origin
from axisrig.kernel.parameters.relations import corrected
from axisrig.kernel.parameters.signal_sources import SOURCES
from axisrig.kernel.parameters.types import Value, written
from axisrig.kernel.parameters.values import Corrected, ParameterSet

SERCOS = 2
DRIVE_TYPE = "kenngr.antr_typ"

OPTIMISED = "lr_param.field_bus_allows_optimized_schedule"
ACTUAL_TRANSFORMATION = "trafo.actual_pos"
NO_BIT, REALTIME_BITS = -1, (6, 7)
_CONTROL, _STATUS = ("S-0-0134",), ("S-0-0135", "S-0-135")
# SERCOS words of a bit, the warning of an unknown process datum and that of an invalid bit
# (TF5200 axis parameters 117340683 to 117363723)
_PROBE_BITS = (
    ("probe_1_realtime_bits.start_probing", _CONTROL, 110612, 110613),
    ("probe_1_realtime_bits.value_latched", _STATUS, 110608, 110609),
    ("probe_1_realtime_bits.probe_actuated", _STATUS, 110610, 110611),
    ("probe_2_realtime_bits.start_probing", _CONTROL, 110612, 110613),
    ("probing_command_start", _CONTROL, 110617, 110618),
)


def start_up(parameters: ParameterSet, name: str) -> list[Alarm]:
    """Correct the parameters of an axis or of the channel as the control does; report each warning.

    name: of the axis; of the channel whatever. To be called once, when everything is set.
    Raises UserError for a probing input that the signal source does not have.
    """
    is_axis = parameters.kind == "axis"
    number = parameters.integer("channel_id") or 1 if parameters.kind == "channel" else 0
    owner = f"axis {name}" if is_axis else f"channel {number}"
    warnings = [_warning(item, owner, name) for item in parameters.corrected()]
    if is_axis:
        _check_input(parameters)
        warnings += _axis(parameters, name)
        warnings += corrected(parameters, name)
    elif parameters.kind == "channel":
        warnings += _channel(parameters, owner)
    return warnings


def equal_schedule(axes: Mapping[str, ParameterSet]) -> list[Alarm]:
    """Take the optimised access to the bus (P-AXIS-00276) from every axis where one lacks it.

    axes: by name. Returns warning 70212 where they differ.
    """
    having = {name: parameters.flag(OPTIMISED) for name, parameters in axes.items()}
    if len(set(having.values())) < 2:
        return []
    for name, has in having.items():
        if has:
            axes[name].correct(OPTIMISED, False)
    named = {want: ", ".join(name for name, has in having.items() if has is want)
             for want in (True, False)}  # fmt: skip
    return [Alarm(70212, axes=named[True], others=named[False])]


def _warning(item: Corrected, owner: str, name: str) -> Alarm:
    """Build the warning of a value out of its range from what its text needs."""
    row = item.parameter
    numbers: dict[str, Value] = {
        "value": item.wrong,
        "low": row.minimum if row.minimum is not None else item.wrong,
        "high": row.maximum if row.maximum is not None else item.wrong,
        "limit": row.maximum if row.maximum is not None else item.wrong,
        "corrected": item.corrected,
    }
    values: dict[str, object] = {
        wanted: written(numbers[wanted.partition("_")[0]])
        for wanted in catalogue()[item.alarm_id].values
        if wanted not in ("owner", "axis")
    }
    return Alarm(item.alarm_id, owner=owner, axis=name, place=item.origin.short, **values)


def drive_type(parameters: ParameterSet) -> DriveType:
    """Return the drive type of an axis (P-AXIS-00020)."""
    return DRIVE_TYPES[parameters.integer(DRIVE_TYPE)]


def _check_input(parameters: ParameterSet) -> None:
    """Refuse an input that the signal source does not have; no ID is documented for it."""
    source = SOURCES[parameters.word(SIGNAL)]
    found = parameters.resolve(INPUT)
    if source.inputs is None or int(found.value) <= source.inputs:
        return
    place = found.origin or Origin(INPUT)
    raise place.error(
        f"signal source {parameters.word(SIGNAL)} has no such probing input",
        value=written(found.value),
        allowed=f"1 .. {source.inputs}",
    )


def _axis(parameters: ParameterSet, axis: str) -> Iterator[Alarm]:
    kind = drive_type(parameters)
    yield from of_drive_type(parameters, axis, kind)
    if kind.number == SERCOS:
        yield from _sercos(parameters, axis)
    yield from _actual_value_transformation(parameters, axis)


def _actual_value_transformation(parameters: ParameterSet, axis: str) -> Iterator[Alarm]:
    """Take an axis out of measuring whose actual positions are transformed."""
    id_ = parameters.integer(f"{ACTUAL_TRANSFORMATION}.id")
    if not (id_ and parameters.flag(f"{ACTUAL_TRANSFORMATION}.enable")):
        return
    if parameters.flag(MEASURES):
        parameters.correct(MEASURES, False)
        yield Alarm(110508, axis=axis, id=id_, wrong=1, corrected=0)
    yield Alarm(900640, axis=axis, id=id_)


def _sercos(parameters: ParameterSet, axis: str) -> Iterator[Alarm]:
    """Check the process data of measuring: without a telegram there are only the SERCOS words.

    What is wrong takes the axis out of measuring and edge banding.
    """
    for what, words, unknown, invalid in _PROBE_BITS:
        path = f"antr.sercos.{what}"
        name = parameters.word(f"{path}.element_name")
        if name and name.replace("_", "-") not in words:
            _release(parameters)
            yield Alarm(unknown, axis=axis, name=name)
        bit = parameters.integer(f"{path}.bit_nr")
        if bit not in (NO_BIT, *REALTIME_BITS):
            _release(parameters)
            yield Alarm(invalid, axis=axis, value=bit)


def _release(parameters: ParameterSet) -> None:
    """Take the axis out of measuring and edge banding."""
    for path in (MEASURES, "kenngr.kasto_achse"):
        if parameters.flag(path):
            parameters.correct(path, False)


def _channel(parameters: ParameterSet, owner: str) -> Iterator[Alarm]:
    """3D distance control has no acceleration to fall back on."""
    path = "dist_ctrl[0].a_max"
    is_3d = parameters.word("configuration.decoder.function") == "FCT_3D_DIST_CTRL"
    if is_3d and parameters.integer(path) == 0:
        parameters.correct(path, 1)
        yield Alarm(315001, owner=owner, value_mm_s2=0, corrected_mm_s2=1)
