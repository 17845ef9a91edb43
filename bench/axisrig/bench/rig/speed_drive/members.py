"""Axes of a rig whose drives only take a speed: their tables, what a list says of the output."""

from axisrig.bench.rig.settings import Settings
from axisrig.bench.rig.speed_drive.keys import SpeedDriveTable
from axisrig.kernel.parameters.signal_sources import SOURCES
from axisrig.kernel.time.clock import US, S

NUMERATOR, DENOMINATOR = "getriebe[0].multi_gain_z", "getriebe[0].multi_gain_n"
M_MIN_PER_MM_S = 0.06


def drive_of(settings: Settings, name: str) -> SpeedDriveTable:
    """Return `[drive.D]` of such an axis."""
    table = settings.rig.drive[settings.rig.axis[name].drive]
    assert isinstance(table, SpeedDriveTable), name
    return table


def listed_counts(settings: Settings, name: str) -> float:
    """Return what the list has for 1 mm/s (P-AXIS-00129 / P-AXIS-00128 for 1 m/min)."""
    parameters = settings.axis[name]
    per_m_min = parameters.integer(NUMERATOR) / parameters.integer(DENOMINATOR)
    return per_m_min * M_MIN_PER_MM_S


def fastest_way_mm(settings: Settings, name: str, cycles: int) -> float:
    """Return how far the axis goes in so many cycles at P-AXIS-00212."""
    fastest_mm_s = settings.axis[name].mm_s("getriebe[0].dynamik.vb_max")
    return fastest_mm_s * cycles * settings.rig.cycle.period_us * US / S


def measures(settings: Settings, name: str) -> bool:
    """Whether an axis measures with the latch of its drive."""
    parameters = settings.axis[name]
    signal = parameters.word("kenngr.measure.signal")
    return parameters.flag("kenngr.messachse") and SOURCES[signal].latched == "drive"


def no_second(settings: Settings, name: str) -> str:
    """Return what brings the second encoder of an axis: nothing."""
    return ""
