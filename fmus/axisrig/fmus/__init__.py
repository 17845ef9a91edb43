"""Plant FMUs of axisrig: a Modelica library and the exporter that builds FMI FMUs from it."""

from axisrig.fmus.build import (
    CATALOGUE,
    FMI_VERSIONS,
    MODELS,
    ensure_built,
    ensure_own_built,
    is_ours,
    place_in_cache,
    shipped_fmu,
)
from axisrig.fmus.compiler import COMPILERS, PLATFORMS, this_platform
from axisrig.fmus.reading.errors import BuildError

__all__ = [
    "CATALOGUE",
    "COMPILERS",
    "FMI_VERSIONS",
    "MODELS",
    "PLATFORMS",
    "BuildError",
    "ensure_built",
    "ensure_own_built",
    "is_ours",
    "place_in_cache",
    "shipped_fmu",
    "this_platform",
]
