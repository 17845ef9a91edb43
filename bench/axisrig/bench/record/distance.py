"""What a run leaves of distance control."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from axisrig.bench.oracles.distance.lists import Control
from axisrig.bench.oracles.distance.loop import BOTH, CONST_DIST, SET_POS
from axisrig.bench.record.axes import Value
from axisrig.bench.record.frozen import Frozen
from axisrig.bench.record.kinematics import GuideChange
from axisrig.kernel.time.clock import TimeNs

ON = ("ACTIVE", "ACTIVE_CONST_DIST")
"""States in which a control follows."""


@dataclass(frozen=True)
class Controller(Frozen):
    """Parameters of a distance control: gains, times, filter; lengths in mm, frequencies in Hz.

    both_encoders: the constant distance follows by sensor and actual position. derivative_of,
    limiter, derivative: choices of the rig, `axisrig.kernel.distance.law`; recordings of versions 1
    to 3 were made with those that are given here.
    """

    kp: float
    tn_s: float
    tv_s: float
    filter_type: str
    count: int
    alpha: float
    order: int
    corner_hz: float
    sigma_mm: float
    both_encoders: bool
    derivative_of: str = "error"
    limiter: str = "clamp"
    derivative: str = "per_second"

    @property
    def control(self) -> Control:
        """The same as the closed forms want it."""
        return Control(
            kp=self.kp,
            tn_s=self.tn_s,
            tv_s=self.tv_s,
            filter_type=self.filter_type,
            count=self.count,
            alpha=self.alpha,
            order=self.order,
            corner_hz=self.corner_hz,
            sigma_mm=self.sigma_mm,
            derivative_of=self.derivative_of,
            limiter=self.limiter,
            derivative=self.derivative,
        )


@dataclass(frozen=True)
class DistanceChange(Frozen):
    """What held for a distance control from a SYNC on. state: name of `DistanceState`.

    by: who commanded it, NC or PLC. sensor: what gives its values.
    """

    time_ns: TimeNs
    state: str
    by: str
    sensor: str
    is_dry_run: bool
    controller: Controller

    @property
    def is_on(self) -> bool:
        """Whether the control follows its sensor."""
        return self.state in ON

    @property
    def mode(self) -> str:
        """Mode of the loop of a control that is on."""
        if self.state == "ACTIVE":
            return SET_POS
        return BOTH if self.controller.both_encoders else CONST_DIST


@dataclass(frozen=True)
class DistanceOrder(Frozen):
    """What was asked of a distance control in the cycle of a SYNC.

    by: NC (after the step of its cycle), PLC (before it) or OBJECT, a CNC object. action: ON,
    ON_CONST_DIST, OFF or FREEZE as it was carried out; empty where only values are given. Of the
    PLC, set values are here only beside one of the program: the series has them. words: parameters
    by their names in the list, after its structure and in its unit; filter_time_s of #DIST CTRL.
    """

    time_ns: TimeNs
    by: str
    action: str = ""
    is_dry_run: bool = False
    set_pos_mm: float | None = None
    set_dist_mm: float | None = None
    words: Mapping[str, Value] = field(default_factory=dict)


@dataclass(frozen=True)
class DistanceRecord(Frozen):
    """Distance control of an axis. variable: V.E. name of the sensor in use, empty for 60E4.

    is_referenced: the program has set the zero of its sensor (REF). orders: None up to version 3.
    """

    variable: str = ""
    is_referenced: bool = False
    changes: tuple[DistanceChange, ...] = ()
    orders: tuple[DistanceOrder, ...] | None = None


@dataclass(frozen=True)
class Diagnosis(Frozen):
    """Diagnosis data of 3D control at a SYNC, by the names of FCT-M3 12.10."""

    time_ns: TimeNs
    values: Mapping[str, str]


@dataclass(frozen=True)
class ChannelDistanceRecord(Frozen):
    """3D distance control of the channel. variable, is_referenced, orders: as in `DistanceRecord`.

    diagnosis: at every change, and at the end of the run. guides: where the offset acted.
    """

    variable: str = ""
    is_referenced: bool = False
    changes: tuple[DistanceChange, ...] = ()
    diagnosis: tuple[Diagnosis, ...] = ()
    guides: tuple[GuideChange, ...] = ()
    orders: tuple[DistanceOrder, ...] | None = None


@dataclass(frozen=True)
class PlcSensor(Frozen):
    """A V.E. variable in which the PLC side shows a distance sensor.

    Of one at an inclined tool: is_along: it measures along the tool; is_normalised: the PLC takes
    that times the cosine of the tilt; normal: of its workpiece as a whole, None where it gives
    none.
    """

    sensor: str
    sign: int
    delay_cycles: int
    is_along: bool = False
    is_normalised: bool = False
    normal: tuple[float, float, float] | None = None
