"""The decoder: statements in, commands of `canon` out; one module per topic."""

from kernel.nc.decoder.context import Context, MachineView
from kernel.nc.decoder.interpreter import Interpreter, check_program
from kernel.nc.decoder.subprograms import missing_files

__all__ = ["Context", "Interpreter", "MachineView", "check_program", "missing_files"]
