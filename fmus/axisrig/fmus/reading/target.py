"""The folder with templates and runtime that every FMU is made from, and which files it takes."""

from pathlib import Path

TARGET = Path(__file__).parent.parent / "target"
RUNTIME = ("runtime.h", "equations.c", "solver.c", "slave.c")
SLAVES = {
    "3.0": ("fmi3.c", "fmi3_absent.c"),
    "2.0": ("fmi2.c", "fmi2_absent.c"),
}


def runtime_files(fmi: str) -> tuple[str, ...]:
    """The files of the target folder that an FMU of version `fmi` is compiled from."""
    return (*RUNTIME, *SLAVES[fmi])
