"""Keys of `[segment.S]` of an EtherCAT line."""

from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field

from axisrig.bench.bus.ethercat.segment import FORWARD_NS, WIRE_NS
from axisrig.bench.rig.reading.tables import SegmentKeys
from axisrig.kernel.time.clock import US, TimeNs

DELAY_MAX_NS = 1_000_000
DRIFT_MAX_PPM = 1000.0


def _number(text: str) -> float | str:
    try:
        value = float(text)
    except ValueError:
        return text
    return int(value) if value.is_integer() else value


def _each(value: Any) -> Any:
    """Read the cell of a plan: a number, or one for each axis, `Z=100 X=-20`."""
    if not isinstance(value, str):
        return value
    if "=" not in value:
        return _number(value)
    parts = (part.partition("=") for part in value.split())
    return {axis: _number(text) for axis, _, text in parts}


def _flag(value: Any) -> Any:
    """Read the cell of a plan: true or false, 1 or 0."""
    known = {"true": True, "false": False, "1": True, "0": False, 1: True, 0: False}
    return known.get(value, value) if isinstance(value, (str, int)) else value


def _cell(value: Any) -> Any:
    return _number(value) if isinstance(value, str) else value


Delay = Annotated[float, Field(ge=0, le=DELAY_MAX_NS)]
Drift = Annotated[float, Field(ge=-DRIFT_MAX_PPM, le=DRIFT_MAX_PPM)]
Shift = Annotated[float, Field(ge=-20_000, le=20_000)]
Start = Annotated[float, Field(ge=-1e9, le=1e9)]
Flag = Annotated[bool, BeforeValidator(_flag)]
Microseconds = Annotated[float, BeforeValidator(_cell), Field(ge=0, le=20_000)]
ClockLimit = Annotated[float, BeforeValidator(_cell), Field(gt=0, le=20_000)]
EachDelay = Annotated[Delay | dict[str, Delay], BeforeValidator(_each)]
EachDrift = Annotated[Drift | dict[str, Drift], BeforeValidator(_each)]
EachShift = Annotated[Shift | dict[str, Shift], BeforeValidator(_each)]
EachStart = Annotated[Start | dict[str, Start], BeforeValidator(_each)]


class SegmentTable(SegmentKeys):
    """`[segment.NAME]`: one line of EtherCAT slaves, in the order of the axes of the rig.

    frame_us: when the cyclic frame leaves, after the begin of a cycle. dc: distributed clocks, and
    SYNC0 as the clock of the drives; else the outputs are. shift_us: SYNC0 after the begin of a
    cycle. overload: what becomes of a cycle that does not fit.
    drift_compensation: the reference time goes to all clocks in each cycle. delay_compensation: the
    delays of the line are measured and written. clock_limit_us: how far clocks may be apart, for
    SYNC0 to begin and for a time stamp to be believed.
    Of each slave, a number for all or a table by axis: wire_ns, of the wire before it; slave_ns, of
    the slave, each way; drift_ppm and clock_start_us, of its clock; sample_us, when it samples
    positions and inputs, after SYNC0; assumed_sample_us, what the control assumes of that, missing
    = the same.
    """

    carrier: Literal["ethercat"]
    frame_us: Microseconds = 0
    dc: Flag = True
    shift_us: Microseconds = 100
    overload: Literal["refuse", "run"] = "refuse"
    drift_compensation: Flag = True
    delay_compensation: Flag = True
    clock_limit_us: ClockLimit = 1.0
    wire_ns: EachDelay = float(WIRE_NS)
    slave_ns: EachDelay = float(FORWARD_NS)
    drift_ppm: EachDrift = 0.0
    clock_start_us: EachStart = 0.0
    sample_us: EachShift = 0.0
    assumed_sample_us: EachShift | None = None

    @property
    def is_line(self) -> bool:
        """One frame passes all of its slaves."""
        return True

    @property
    def frame_ns(self) -> TimeNs:
        """When the cyclic frame leaves."""
        return round(self.frame_us * US)

    @property
    def shift_ns(self) -> TimeNs:
        """When SYNC0 comes."""
        return round(self.shift_us * US)

    def of(self, key: str, axis: str) -> float:
        """Return what a key says of the slave of an axis."""
        value = getattr(self, key)
        if isinstance(value, Mapping):
            value = value.get(axis, type(self).model_fields[key].default)
        return self.of("sample_us", axis) if value is None else float(value)


EACH = ("wire_ns", "slave_ns", "drift_ppm", "clock_start_us", "sample_us", "assumed_sample_us")
"""Keys that may differ from slave to slave."""
