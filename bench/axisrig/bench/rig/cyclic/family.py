"""Drives on cyclic segments as a rig asks for them."""

from axisrig.bench.rig.cyclic.members import (
    axes_on,
    cyclic_axes,
    cyclic_segments,
    instants_of,
    phases_of,
)
from axisrig.bench.rig.cyclic.on_segment import on_segment
from axisrig.bench.rig.families import RigFamily, SecondEncoder
from axisrig.bench.rig.reading.file import rig_error
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.time.clock import US, TimeNs


class OnCyclic(RigFamily):
    """Drives on cyclic segments."""

    fault_rooms = ("images", "drives")

    def check(self, settings: Settings) -> None:
        """Check instants and drives. Raises UserError with file, line and key of the rig."""
        for segment in cyclic_segments(settings):
            _check_instants(settings, segment)
        for name in cyclic_axes(settings):
            on_segment(settings, name).check(settings, name, _way_ns(settings, name))

    def describe(self, settings: Settings) -> list[str]:
        """Say where loops are closed, and when values act and are seen."""
        lines = []
        for name in cyclic_axes(settings):
            lines += on_segment(settings, name).describe(settings, name, _way_ns(settings, name))
            at = instants_of(settings, settings.rig.axis[name].segment)
            lines.append(
                f"axis {name}: positions sampled {at.input_ns / US:g} us before a cycle, images"
                f" swapped at {at.bus_ns / US:g} us, set values taken at {at.output_ns / US:g} us;"
                f" what an NC cycle sends is seen {phases_of(settings, name).way} cycles later"
            )
        return lines

    def second_encoder(self, settings: Settings, axis: str) -> SecondEncoder | None:
        """Return how the second encoder comes, None where it does not."""
        words = on_segment(settings, axis).second(settings, axis)
        return SecondEncoder(words, 1, settings.rig.cycle.period_us * US) if words else None

    def late_cycles(self, settings: Settings, axis: str) -> int:
        """Return by how many cycles more than 2 an NC cycle sees what its set values do."""
        return phases_of(settings, axis).late_cycles

    def fresh_late_cycles(self, settings: Settings, axis: str) -> int:
        """Return the same of what the PLC reads as it was when set values were taken."""
        return phases_of(settings, axis).fresh_late_cycles


def _way_ns(settings: Settings, name: str) -> TimeNs:
    """Return the time from the sample of a position to the set value that is made of it."""
    at = instants_of(settings, settings.rig.axis[name].segment)
    return at.input_ns + at.period_ns + at.output_ns


def _check_instants(settings: Settings, segment: str) -> None:
    """Refuse instants of which one comes before what it needs."""
    at, cycle_ns = instants_of(settings, segment), settings.rig.cycle.cycle_offset_us * US
    wrong = [
        ("input_us", at.input_ns, at.period_ns - at.bus_ns, "less than period_us - bus_us"),
        ("bus_us", at.bus_ns, cycle_ns + 1, "cycle_offset_us at most: the control reads then"),
        ("output_us", at.output_ns, at.period_ns, "less than period_us"),
    ]
    for key, value_ns, limit_ns, allowed in wrong:
        if value_ns >= limit_ns:
            raise rig_error(
                settings.files,
                ("segment", segment, key),
                f"segment {segment}: {key} does not fit into the cycle",
                value=value_ns / US,
                allowed=allowed,
            )
    if at.output_ns < at.bus_ns:
        raise rig_error(
            settings.files,
            ("segment", segment, "output_us"),
            f"segment {segment}: drives take their set values before these have come",
            value=at.output_ns / US,
            allowed=f"bus_us = {at.bus_ns / US:g} or more",
        )
    if not axes_on(settings, segment):
        raise rig_error(
            settings.files, ("segment", segment), f"no axis is on segment {segment}: it needs one"
        )


FAMILY = OnCyclic()
