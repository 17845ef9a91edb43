"""Results folders as tables of pandas: `from axisrig.results import load`."""

from axisrig.results.loading import Results, load

__all__ = ["Results", "load"]
