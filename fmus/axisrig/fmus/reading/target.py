"""The folder with templates and runtime that every FMU is made from, and which files it takes."""

from pathlib import Path

TARGET = Path(__file__).parent.parent / "target"
RUNTIME = ("runtime.h", "equations.inc", "solver.inc", "slave.inc")
SLAVES = {
    "3.0": ("fmi3.inc", "fmi3_absent.inc"),
    "2.0": ("fmi2.inc", "fmi2_absent.inc"),
}


def runtime_files(fmi: str) -> tuple[str, ...]:
    """The files of the target folder that an FMU of version `fmi` is compiled from."""
    return (*RUNTIME, *SLAVES[fmi])
