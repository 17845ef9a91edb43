"""Parameters of distance control."""

from dataclasses import dataclass, field, fields, replace
from typing import Any

from axisrig.kernel.distance.filters import FilterSettings
from axisrig.kernel.distance.filters.build import OF_AXIS, OF_CHANNEL
from axisrig.kernel.distance.law import USUAL_LAW, DistanceLaw
from axisrig.kernel.errors import Alarm
from axisrig.kernel.parameters import ParameterSet

# How lists write the structure since V3.1.3080.12; before that it was kenngr.distc
NEWER_NAMES = "kenngr.dist_ctrl["

_FILTER_FIELDS = {item.name for item in fields(FilterSettings)}


@dataclass(frozen=True)
class DistanceSettings:
    """Parameters of a distance control; for a rotary axis mm reads degrees.

    The numbers are those of an axis; the channel has the same from P-CHAN-00800 on.

    kp, tn_s, tv_s: P-AXIS-00759, 00764, 00765. both_encoders: 00500. max_deviation_mm: 00414.
    v_max_mm_s: 00415. a_max_mm_s2: 00416, 0 for a_axis_mm_s2: 00008. v_weight_down_permille and
    a_weight_down_permille: 00533 and 00534, 0 for none. is_adaptive, a_min_mm_s2, error_a_min_mm,
    error_a_max_mm: 00501 to 00505. max_change_mm_s: 00417. min_pos_mm, max_pos_mm, tolerance_mm:
    00420, 00419, 00421. has_absolute_sensor: whether 00418 is set. is_newer: 3100xx, not 703xx.
    sensor_sign: -1 where the value that the limits are of grows when the tool lifts (3D). law: what
    the rig has chosen of the law.
    """

    kp: float = 1.0
    tn_s: float = 0.0
    tv_s: float = 0.0
    both_encoders: bool = False
    max_deviation_mm: float = 5.0
    v_max_mm_s: float = 5.0
    a_max_mm_s2: float = 0.0
    a_axis_mm_s2: float = 1000.0
    v_weight_down_permille: int = 0
    a_weight_down_permille: int = 0
    is_adaptive: bool = False
    a_min_mm_s2: float = 500.0
    error_a_min_mm: float = 0.1
    error_a_max_mm: float = 0.5
    max_change_mm_s: float = 5.0
    min_pos_mm: float = -5.0
    max_pos_mm: float = 5.0
    tolerance_mm: float = 0.0
    has_absolute_sensor: bool = False
    is_newer: bool = False
    sensor_sign: int = 1
    filter: FilterSettings = field(default_factory=FilterSettings)
    law: DistanceLaw = USUAL_LAW

    @classmethod
    def read(
        cls,
        parameters: ParameterSet,
        prefix: str = OF_AXIS,
        law: DistanceLaw = USUAL_LAW,
    ) -> "DistanceSettings":
        """Take the parameters of a list, each through its fallback.

        prefix: `OF_AXIS`, or `OF_CHANNEL`, which has no acceleration to fall back on and newer IDs.
        law: choices of the rig.
        """
        is_channel = prefix == OF_CHANNEL

        def mm(name: str) -> float:
            return parameters.mm(prefix + name)

        def number(name: str) -> float:
            return float(parameters.get(prefix + name))

        return cls(
            kp=number("kp"),
            tn_s=number("i_tn"),
            tv_s=number("d_tv"),
            both_encoders=parameters.flag(prefix + "mode_dist_use_both_encoder"),
            max_deviation_mm=mm("max_deviation"),
            v_max_mm_s=parameters.mm_s(prefix + "v_max"),
            a_max_mm_s2=parameters.mm_s2(prefix + "a_max"),
            a_axis_mm_s2=0.0 if is_channel else parameters.mm_s2("getriebe[0].dynamik.a_max"),
            v_weight_down_permille=parameters.integer(prefix + "v_weight_down"),
            a_weight_down_permille=parameters.integer(prefix + "a_weight_down"),
            is_adaptive=parameters.flag(prefix + "use_adaptive_acceleration"),
            a_min_mm_s2=parameters.mm_s2(prefix + "a_min"),
            error_a_min_mm=mm("dist_error_a_min"),
            error_a_max_mm=mm("dist_error_a_max"),
            max_change_mm_s=parameters.mm_s(prefix + "max_act_value_change"),
            min_pos_mm=mm("min_pos"),
            max_pos_mm=mm("max_pos"),
            tolerance_mm=mm("tolerance"),
            has_absolute_sensor=mm("ref_offset") != 0,
            is_newer=is_channel or names_newer(parameters),
            sensor_sign=-1 if is_channel else 1,
            filter=FilterSettings.read(parameters, prefix),
            law=law,
        )

    @property
    def a_mm_s2(self) -> float:
        """Largest acceleration of the offset."""
        return self.a_max_mm_s2 or self.a_axis_mm_s2

    def replaced(self, **changes: Any) -> "DistanceSettings":
        """Return these settings with others in place; also those of the filter by their names.

        filter_type is the kind of the filter. Raises TypeError for a name that there is not.
        """
        named = {field_name(name): value for name, value in changes.items()}
        of_filter = {name: value for name, value in named.items() if name in _FILTER_FIELDS}
        own = {name: value for name, value in named.items() if name not in _FILTER_FIELDS}
        if of_filter:
            own["filter"] = replace(own.get("filter", self.filter), **of_filter)
        return replace(self, **own)

    def alarm(self, alarm_ids: tuple[int, ...], **values: Any) -> Alarm:
        """Build an alarm of this family of IDs; alarm_ids: the newer one and, if any, the older."""
        return Alarm(alarm_ids[0 if self.is_newer else -1], **values)


def field_name(name: str) -> str:
    """Return how the settings call a parameter: filter_type is the kind of the filter."""
    return "kind" if name == "filter_type" else name


def names_newer(parameters: ParameterSet) -> bool:
    """Whether an axis names its distance control by the newer structure, and so by its IDs."""
    return parameters.is_written_as(NEWER_NAMES)
