"""The decoder: statements in, commands of `canon` out; one module per topic."""

from axisrig.kernel.nc.decoder.base.context import Context, MachineView
from axisrig.kernel.nc.decoder.base.subprograms import missing_files
from axisrig.kernel.nc.decoder.interpreter import Interpreter, check_program

__all__ = ["Context", "Interpreter", "MachineView", "check_program", "missing_files"]
