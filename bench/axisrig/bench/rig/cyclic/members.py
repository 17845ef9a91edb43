"""Which axes and segments of a rig are cyclic, and their instants."""

from axisrig.bench.bus.cyclic.segment import Instants
from axisrig.bench.oracles.phases import Phases
from axisrig.bench.rig.cyclic.keys import SegmentTable
from axisrig.bench.rig.settings import Settings, once
from axisrig.kernel.time.clock import US


def cyclic_segments(settings: Settings) -> list[str]:
    """Return the cyclic segments, in the order of the rig."""
    return [name for name, table in settings.segment.items() if isinstance(table, SegmentTable)]


def axes_on(settings: Settings, segment: str) -> list[str]:
    """Return the axes of a segment, in the order of the rig."""
    return [name for name, axis in settings.rig.axis.items() if axis.segment == segment]


def cyclic_axes(settings: Settings) -> list[str]:
    """Return the axes on cyclic segments, in the order of the rig."""
    segments = cyclic_segments(settings)
    return [name for name, axis in settings.rig.axis.items() if axis.segment in segments]


@once
def instants_of(settings: Settings, segment: str) -> Instants:
    """Return the instants of a segment."""
    table = settings.segment[segment]
    assert isinstance(table, SegmentTable), segment
    return Instants(
        settings.rig.cycle.period_us * US,
        table.ns("input_us"),
        table.ns("bus_us"),
        table.ns("output_us"),
        table.ns("request_us"),
    )


@once
def phases_of(settings: Settings, name: str) -> Phases:
    """Return the phases of an axis; the images are swapped as one frame with both ways."""
    at = instants_of(settings, settings.rig.axis[name].segment)
    return Phases(
        period_ns=at.period_ns,
        cycle_ns=settings.rig.cycle.cycle_offset_us * US,
        frame_ns=0,
        sync_ns=at.output_ns,
        sample_ns=(at.period_ns - at.input_ns) % at.period_ns,
        passing_ns=at.bus_ns,
        back_ns=at.bus_ns,
    )
