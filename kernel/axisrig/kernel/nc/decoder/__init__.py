"""The decoder: statements in, commands of `canon` out; one module per topic."""

from axisrig.kernel.nc.decoder.context import Context, MachineView
from axisrig.kernel.nc.decoder.interpreter import Interpreter, check_program
from axisrig.kernel.nc.decoder.subprograms import missing_files

__all__ = ["Context", "Interpreter", "MachineView", "check_program", "missing_files"]
