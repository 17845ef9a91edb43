"""Parameters of distance control, read from what the lists say.

Source: FCT-M3 9, P-AXIS-00413 to 00428, 00500 to 00509, 00533, 00534, 00759 to 00784. The newer
structure `kenngr.dist_ctrl[0].` wins over the older `kenngr.distc.`. The channel has the same in
`dist_ctrl[0].` for 3D control: FCT-M3 12.8, P-CHAN-00800 to 00827.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Protocol

from axisrig.kernel.time.clock import S, TimeNs

Written = Mapping[str, object]
"""Parameter -> value, only of those that a list or a plan has written."""

NEWER, OLDER = "kenngr.dist_ctrl[0].", "kenngr.distc."
CHANNEL = "channel"
"""Name of 3D control, the one control of the channel, beside the axes with their own."""
OF_AXIS, OF_CHANNEL = (NEWER, OLDER), ("dist_ctrl[0].",)
"""Names of the structure in the list of an axis and of the channel, the one that wins first."""
PER_MM = 10_000.0  # the lists count in 0.1 um
UM = 1e-3
# Older German words: FCT-M3 9.2
_ALIASES = {
    "max_deviation": "max_abweichung",
    "max_act_value_change": "max_istw_sprung",
    "tolerance": "toleranz",
}
_AXIS_ACCELERATION, _ACCELERATION_OTHERWISE = "getriebe[0].dynamik.a_max", 1000.0
_LEAST_ACCELERATION = 1.0
_AXIS_RAMPS = tuple(f"getriebe[0].lslope_profil.a_grenz_stufe_{k}" for k in (1, 2))
_AXIS_SPEEDS = ("getriebe[0].vb_eilgang", "getriebe[0].dynamik.vb_max")


class Choices(Protocol):
    """What a rig has chosen of the law, [distance]; see `Control`."""

    @property
    def derivative_of(self) -> str: ...  # noqa: D102

    @property
    def limiter(self) -> str: ...  # noqa: D102

    @property
    def derivative(self) -> str: ...  # noqa: D102


@dataclass(frozen=True)
class Limits:
    """What holds the offset and what raises. mm, mm/s, mm/s2.

    change_mm_s: P-AXIS-00417, None = not watched. low_mm, high_mm: of the sensor, tolerance taken
    off. weights: per mille towards the workpiece, 0 = none.
    """

    v_mm_s: float
    a_mm_s2: float
    deviation_mm: float
    change_mm_s: float
    low_mm: float
    high_mm: float
    v_weight: float = 0.0
    a_weight: float = 0.0
    adaptive: tuple[float, float, float] | None = None  # a_min, error of a_min, error of a_max


@dataclass(frozen=True)
class Control:
    """The controller: kp, Tn and Tv in s (0 = off), filter with its numbers (FCT-M3 4).

    derivative_of, limiter, derivative: what the rig has chosen of the law ([distance]); no list has
    them, `as_written` gives the usual ones.
    """

    kp: float = 1.0
    tn_s: float = 0.0
    tv_s: float = 0.0
    filter_type: str = "DEFAULT"
    count: int = 4
    alpha: float = 0.7
    order: int = 4
    corner_hz: float = 25.0
    sigma_mm: float = 0.1
    derivative_of: str = "feedback"
    limiter: str = "slope"
    derivative: str = "per_second"

    @property
    def is_sloped(self) -> bool:
        """Whether a step towards the error is never larger than one that can stop there."""
        return self.limiter == "slope"

    @property
    def looks_at_error(self) -> bool:
        """Whether the derivative part takes the change of the error, not of the feedback."""
        return self.derivative_of == "error"

    def integral(self, period_ns: TimeNs) -> float:
        """Return g, by which the sum of errors counts in a cycle: T/Tn, 0 without Tn."""
        return period_ns / S / self.tn_s if self.tn_s else 0.0

    def rate(self, period_ns: TimeNs) -> float:
        """Return r, by which a change from cycle to cycle counts: Tv/T, or Tv per cycle."""
        return self.tv_s * S / period_ns if self.derivative == "per_second" else self.tv_s


@dataclass(frozen=True)
class Listed:
    """All of an axis.

    sign: -1 when P-AXIS-00230 inverts the sensor. ref_offset_mm: P-AXIS-00418. mm_per_increment:
    """

    limits: Limits
    control: Control
    sign: int
    ref_offset_mm: float
    mm_per_increment: float
    is_optimized: bool
    uses_both: bool

    def sensor_mm(self, increments: float) -> float:
        """Return the sensor value: increments times resolution, sign, reference offset."""
        return self.sign * increments * self.mm_per_increment - self.ref_offset_mm

    def choosing(self, rig: Choices) -> "Listed":
        """Return the same under the law that a rig has chosen."""
        control = replace(
            self.control,
            derivative_of=str(rig.derivative_of),
            limiter=str(rig.limiter),
            derivative=str(rig.derivative),
        )
        return replace(self, control=control)


def as_written(written: Written, stems: tuple[str, ...] = OF_AXIS) -> Listed:
    """Read the parameters of one axis, or with OF_CHANNEL those of the channel.

    The channel has no acceleration to fall back on; without one it is 1
    mm/s2 (docs/distance-3d.md).
    """

    def number(name: str, otherwise: float) -> float:
        for stem in stems:
            for word in (name, _ALIASES.get(name, name)):
                value = written.get(stem + word)
                if value is not None:
                    assert isinstance(value, int | float)
                    return float(value)
        return otherwise

    def text(name: str, otherwise: str) -> str:
        for stem in stems:
            if stem + name in written:
                return str(written[stem + name])
        return otherwise

    tolerance = number("tolerance", 0)
    acceleration = number("a_max", 0) or _of_axis(written, stems)
    adaptive = None
    if number("use_adaptive_acceleration", 0):
        low, high = number("dist_error_a_min", 1000), number("dist_error_a_max", 5000)
        adaptive = (number("a_min", 500), low / PER_MM, high / PER_MM)
    limits = Limits(
        v_mm_s=number("v_max", 5000) * UM,
        a_mm_s2=acceleration,
        deviation_mm=number("max_deviation", 50000) / PER_MM,
        change_mm_s=number("max_act_value_change", 5000) * UM,
        low_mm=(number("min_pos", -50000) + tolerance) / PER_MM,
        high_mm=(number("max_pos", 50000) - tolerance) / PER_MM,
        v_weight=number("v_weight_down", 0),
        a_weight=number("a_weight_down", 0),
        adaptive=adaptive,
    )
    filter_type = text("filter_type", "DEFAULT")
    if filter_type == "DEFAULT" and number("low_pass_filter_enable", 0):
        filter_type = "LOWPASS"
    control = Control(
        kp=number("kp", 1.0),
        tn_s=number("i_tn", 0.0),
        tv_s=number("d_tv", 0.0),
        filter_type=filter_type,
        count=int(number("n_cycles", 4)),
        alpha=number("smoothing_factor", 0.7),
        order=int(number("low_pass_filter_order", 4)),
        corner_hz=number("low_pass_filter_fg_f0", 25.0),
        sigma_mm=number("kalman_sigma", 1000) / PER_MM,
    )
    resolution = _plain(written, "lr_hw[1].encoder_resolution_denom", 1.0) / _plain(
        written, "lr_hw[1].encoder_resolution_num", 1.0
    )
    return Listed(
        limits,
        control,
        sign=-1 if _plain(written, "lr_hw[1].vz_istw", 0) else 1,
        ref_offset_mm=number("ref_offset", 0) / PER_MM,
        mm_per_increment=resolution / PER_MM,
        is_optimized=bool(number("optimized_scheduling", 0)),
        uses_both=bool(number("mode_dist_use_both_encoder", 0)),
    )


def _of_axis(written: Written, stems: tuple[str, ...]) -> float:
    if stems != OF_AXIS:
        return _LEAST_ACCELERATION
    return _plain(written, _AXIS_ACCELERATION, _ACCELERATION_OTHERWISE)


def axis_limits(written: Written) -> tuple[float, float]:
    """Return speed and acceleration that an axis may have whatever moves it, mm/s and mm/s2.

    Rapid traverse (P-AXIS-00209, at most 00212) and P-AXIS-00008; without that the lesser ramp of
    rapid traverse (00005, 00006). Infinite where the list says nothing.
    """
    speeds = [_plain(written, name, math.inf) * UM for name in _AXIS_SPEEDS]
    acceleration = _plain(written, _AXIS_ACCELERATION, 0.0)
    ramps = [_plain(written, name, math.inf) for name in _AXIS_RAMPS]
    return min(speeds), acceleration or min(ramps)


def _plain(written: Written, name: str, otherwise: float) -> float:
    value = written.get(name, otherwise)
    assert isinstance(value, int | float)
    return float(value)


def cycles_of(time_s: float, period_ns: TimeNs) -> float:
    """Return a time in cycles, not rounded."""
    return time_s * S / period_ns
