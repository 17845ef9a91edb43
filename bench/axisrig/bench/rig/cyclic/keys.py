"""Keys of `[segment.S]` of a segment that swaps images once per cycle."""

from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field

from axisrig.bench.rig.habit_keys import number
from axisrig.bench.rig.reading.tables import SegmentKeys
from axisrig.kernel.time.clock import US, TimeNs


def _cell(value: Any) -> Any:
    return number(value) if isinstance(value, str) else value


Microseconds = Annotated[float, BeforeValidator(_cell), Field(ge=0, le=20_000)]


class SegmentTable(SegmentKeys):
    """`[segment.NAME]`: images in and out once per cycle at stated instants.

    input_us: the drives sample so long before a cycle begins (T_I). bus_us: the images have been
    swapped so long after its begin (T_DX). output_us: the drives take their set values so long
    after it (T_O). request_us: from a request beside the cycle to its response.
    """

    carrier: Literal["cyclic"]
    input_us: Microseconds = 0.0
    bus_us: Microseconds = 0.0
    output_us: Microseconds = 0.0
    request_us: Annotated[float, BeforeValidator(_cell), Field(ge=2, le=1_000_000)] = 10_000.0

    @property
    def swaps_images(self) -> bool:
        """It does nothing else."""
        return True

    def ns(self, key: str) -> TimeNs:
        """Return one of the instants in ns."""
        return round(float(getattr(self, key)) * US)
