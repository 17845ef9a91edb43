"""Filters of the sensor value: `filters.csv` names them, `make_filter` builds them."""

from axisrig.kernel.distance.filters.build import FilterSettings, make_filter
from axisrig.kernel.distance.filters.filter import Filter, memory_cycles
from axisrig.kernel.distance.filters.table import FilterKind, filter_kinds

__all__ = ["Filter", "FilterKind", "FilterSettings", "filter_kinds", "make_filter", "memory_cycles"]
