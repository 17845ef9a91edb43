"""Entries of `[plc]`: V.E. variables in which the PLC side shows what distance sensors measure."""

import re
from typing import Annotated, Literal

from pydantic import AfterValidator, Field

from axisrig.bench.rig.reading.tables import Name, Table
from axisrig.kernel.time.clock import MS, TimeNs

_VARIABLE = re.compile(r"V\.E\.([A-Za-z_][A-Za-z0-9_.]*)")
DELAY_MAX = 20


def _variable(name: str) -> str:
    if not _VARIABLE.fullmatch(name):
        raise ValueError('a variable of the PLC is needed, in quotes: "V.E.SENSOR"')
    return name


VariableName = Annotated[str, AfterValidator(_variable)]


class PlcSensorTable(Table):
    """An entry of `[plc]`: where a V.E. variable comes from.

    sensor: plant of a distance sensor. unit_um: length of one; distance control takes a variable in
    0.1 um. sign: -1 turns the direction round. delay_cycles: age of the value, in NC cycles.
    period_ms: the PLC promises a value at least so often, and reads one as often as whole cycles
    allow; None: it reads in every cycle and promises nothing. silent_from_ms: simulated loss, from
    this time after the start of the program on the PLC reads no more; None: it always reads.

    normalise: what the PLC makes of the value by the tilt that the kernel shows: nothing; the
    orthogonal distance from one along the tool; or from what a disc electrode across the tool gives
    (electrode_radius_mm, tilt_factor as its FMU has them). Wrong on purpose: tilt_error_deg, what
    is added to the tilt; tilt_delay_cycles, how old the tilt is beside the value.
    """

    sensor: Name
    unit_um: Annotated[float, Field(gt=0, le=1e6)] = 0.1
    sign: Literal[1, -1] = 1
    delay_cycles: Annotated[int, Field(ge=0, le=DELAY_MAX)] = 0
    period_ms: Annotated[float, Field(gt=0, le=60_000)] | None = None
    silent_from_ms: Annotated[float, Field(ge=0)] | None = None
    normalise: Literal["none", "along", "electrode"] = "none"
    electrode_radius_mm: Annotated[float, Field(gt=0, le=1000)] = 2.0
    tilt_factor: Annotated[float, Field(ge=1, le=20)] = 1.0
    tilt_error_deg: Annotated[float, Field(gt=-90, lt=90)] = 0.0
    tilt_delay_cycles: Annotated[int, Field(ge=0, le=DELAY_MAX)] = 0

    def every(self, cycle_ns: TimeNs) -> int:
        """Return with every how many cycles the PLC reads."""
        return 1 if self.period_ms is None else max(1, round(self.period_ms * MS) // cycle_ns)
