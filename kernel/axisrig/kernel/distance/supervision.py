"""What distance control watches while it follows its sensor; each raises an alarm of class 7."""

from dataclasses import dataclass
from typing import Final

from axisrig.kernel.distance.settings import DistanceSettings
from axisrig.kernel.errors import Alarm
from axisrig.kernel.time.clock import TimeNs, ns_to_seconds

SILENT = (900314,)
# Newer and older ID
CHANGE = (310018, 70329)
ABOVE = (310019, 70330)
BELOW = (310020, 70576)
DEVIATION = (310017, 70331)

# Far below any sensor: two values that should be equal differ by the rounding of floats
ROUNDING_MM: Final = 1e-9
UM: Final = 1000


@dataclass(frozen=True)
class Silence:
    """A sensor that has been silent for too long.

    source: in words. age_ms: of its value. limit_ms: what was allowed.
    """

    source: str
    age_ms: float
    limit_ms: float

    def alarm(self, owner: str, settings: DistanceSettings) -> Alarm:
        """Build Alarm 900314."""
        return settings.alarm(
            SILENT,
            owner=owner,
            source=self.source,
            age_ms=f"{self.age_ms:g}",
            limit_ms=f"{self.limit_ms:g}",
        )


def change_alarm(
    owner: str, change_mm: float, period_ns: TimeNs, settings: DistanceSettings
) -> Alarm | None:
    """Return the alarm of a sensor value that changes too fast from cycle to cycle (00417)."""
    period_s = ns_to_seconds(period_ns)
    if abs(change_mm) <= settings.max_change_mm_s * period_s + ROUNDING_MM:
        return None
    return settings.alarm(
        CHANGE,
        owner=owner,
        change_um_s=round(abs(change_mm) / period_s * UM, 3),
        limit_um_s=round(settings.max_change_mm_s * UM, 3),
    )


def range_alarm(owner: str, sensor_mm: float, settings: DistanceSettings) -> Alarm | None:
    """Return the alarm of a sensor value outside limits less tolerance (00419 to 00421).

    The limits of the channel are those of the value as the PLC gives it, which grows when the tool
    lifts.
    """
    sensor_mm *= settings.sensor_sign
    highest_mm = settings.max_pos_mm - settings.tolerance_mm
    lowest_mm = settings.min_pos_mm + settings.tolerance_mm
    value_mm = round(sensor_mm, 6) + 0.0  # no minus zero
    if sensor_mm > highest_mm + ROUNDING_MM:
        return settings.alarm(ABOVE, owner=owner, value_mm=value_mm, limit_mm=round(highest_mm, 6))
    if sensor_mm < lowest_mm - ROUNDING_MM:
        return settings.alarm(BELOW, owner=owner, value_mm=value_mm, limit_mm=round(lowest_mm, 6))
    return None


def deviation_alarm(
    owner: str, wanted_mm: float, offset_mm: float, settings: DistanceSettings
) -> Alarm | None:
    """Return the alarm of an offset that is wanted above its limit (00414)."""
    if abs(wanted_mm) <= settings.max_deviation_mm:
        return None
    return settings.alarm(
        DEVIATION,
        owner=owner,
        deviation_mm=round(wanted_mm, 6),
        limit_mm=settings.max_deviation_mm,
        offset_mm=offset_mm,
    )
