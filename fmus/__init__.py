"""Plant FMUs of axisrig: a Modelica library and the exporter that builds FMI 3.0 FMUs from it."""

from fmus.build import CATALOGUE, MODELS, ensure_built
from fmus.errors import BuildError

__all__ = ["CATALOGUE", "MODELS", "BuildError", "ensure_built"]
