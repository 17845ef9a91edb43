"""From parameters to a filter."""

from dataclasses import dataclass
from enum import IntEnum

from axisrig.kernel.distance.filters.filter import Filter
from axisrig.kernel.distance.filters.low_pass import LowPass
from axisrig.kernel.distance.filters.table import filter_kinds
from axisrig.kernel.distance.filters.weighted import (
    WeightedFilter,
    exponential_weights,
    kalman_weights,
    mean_weights,
)
from axisrig.kernel.errors import Alarm
from axisrig.kernel.parameters.table import Parameter, table
from axisrig.kernel.parameters.units import UNITS_PER_MM
from axisrig.kernel.parameters.values import ParameterSet
from axisrig.kernel.time.clock import US, S, TimeNs

# Where a list has distance control: that of an axis, that of the channel (3D)
OF_AXIS = "kenngr.dist_ctrl[0]."
OF_CHANNEL = "dist_ctrl[0]."


class LowPassCode(IntEnum):
    """First value of 310001: what is wrong with the low-pass (our numbers)."""

    ORDER = 1
    FREQUENCY_TOO_HIGH = 2
    NO_FREQUENCY = 3


class FilterCode(IntEnum):
    """First value of 310003: what is wrong with the filter (our numbers)."""

    UNKNOWN_TYPE = 1
    N_CYCLES = 2
    SMOOTHING_FACTOR = 3
    KALMAN_SIGMA = 4


@dataclass(frozen=True)
class FilterSettings:
    """Parameters of all filters, in the units of the manual.

    kind: ident of `filters.csv` (P-AXIS-00782). n_cycles (00413). smoothing_factor: share of the
    newest value (00784). kalman_sigma: standard deviation of a measured value, 0.1 um (00783).
    low_pass_filter_order (00507), low_pass_filter_fg_f0: Hz (00508). prefix: of the list that has
    the ranges.
    """

    kind: str = "DEFAULT"
    n_cycles: int = 4
    smoothing_factor: float = 0.7
    kalman_sigma: float = 1000.0
    low_pass_filter_order: int = 4
    low_pass_filter_fg_f0: float = 25.0
    prefix: str = OF_AXIS

    @classmethod
    def read(cls, parameters: ParameterSet, prefix: str) -> "FilterSettings":
        """Read them from a list. prefix: `kenngr.dist_ctrl[0].` of an axis, `dist_ctrl[0].`.

        The older switch low_pass_filter_enable (00506) chooses LOWPASS where the filter is DEFAULT.
        """
        kind = parameters.word(f"{prefix}filter_type").upper()
        if kind == "DEFAULT" and parameters.flag(f"{prefix}low_pass_filter_enable"):
            kind = "LOWPASS"
        return cls(
            kind,
            parameters.integer(f"{prefix}n_cycles"),
            float(parameters.get(f"{prefix}smoothing_factor")),
            float(parameters.get(f"{prefix}kalman_sigma")),
            parameters.integer(f"{prefix}low_pass_filter_order"),
            float(parameters.get(f"{prefix}low_pass_filter_fg_f0")),
            prefix,
        )


def parameter_row(prefix: str, name: str) -> Parameter:
    """Return the row of a parameter of distance control in the table of its list."""
    row, _ = table("channel" if prefix == OF_CHANNEL else "axis").find(prefix + name)
    return row


def make_filter(kind: str, settings: FilterSettings, period_ns: TimeNs, owner: str = "") -> Filter:
    """Build a filter that rests at 0.

    kind: ident of `filters.csv`. period_ns: NC cycle. owner: axis or channel, for the alarms.
    Raises Alarm 310001 for a low-pass and 310003 for another filter that cannot exist.
    """
    row = filter_kinds().get(kind)
    if row is None:
        raise Alarm(310003, owner=owner, code=int(FilterCode.UNKNOWN_TYPE), filter=kind)
    if row.model == "low_pass":
        return _low_pass(settings, period_ns, owner)
    _check(row.parameters, settings, kind, owner)
    mean = mean_weights(settings.n_cycles)
    if "smoothing_factor" in row.parameters:
        mean = exponential_weights(settings.n_cycles, settings.smoothing_factor)
    if "kalman_sigma" in row.parameters:
        # P-AXIS-00783 (docs/ambiguities.md) is in 0.1 um, as all lengths of the lists
        return WeightedFilter(kalman_weights(mean, settings.kalman_sigma / UNITS_PER_MM))
    return WeightedFilter(mean)


def _check(parameters: tuple[str, ...], settings: FilterSettings, kind: str, owner: str) -> None:
    """Refuse what no filter can have; lists correct it and programs refuse it before."""
    for name in parameters:
        if not _is_within(name, settings):
            raise Alarm(310003, owner=owner, code=int(FilterCode[name.upper()]), filter=kind)


def _is_within(name: str, settings: FilterSettings) -> bool:
    """Whether a value is in the range that the parameter tables give it."""
    return parameter_row(settings.prefix, name).is_within(getattr(settings, name))


def _low_pass(settings: FilterSettings, period_ns: TimeNs, owner: str) -> Filter:
    order, f0_hz = settings.low_pass_filter_order, settings.low_pass_filter_fg_f0
    code = None
    if not _is_within("low_pass_filter_order", settings):
        code = LowPassCode.ORDER
    elif order and not f0_hz > 0:
        code = LowPassCode.NO_FREQUENCY
    elif order and 2 * f0_hz * period_ns >= S:
        code = LowPassCode.FREQUENCY_TOO_HIGH
    if code is not None:
        cycle_us = period_ns / US
        raise Alarm(
            310001, owner=owner, code=int(code), order=order, f0_hz=f0_hz, cycle_us=cycle_us
        )
    return LowPass(order, f0_hz, period_ns) if order else WeightedFilter([1.0])
