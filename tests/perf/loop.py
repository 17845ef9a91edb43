"""The loops in C over functions of FMUs (step_loop.c), compiled for this machine."""

import ctypes
import tempfile
from pathlib import Path
from typing import Any

from axisrig.fmus.compiler import compile_library, find_compiler, this_platform

LOOP = Path(__file__).with_name("step_loop.c")


def compiled_loops() -> Any:
    """Return the library of step_loop.c. Raises BuildError when there is no C compiler."""
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        source = Path(folder) / LOOP.name
        source.write_bytes(LOOP.read_bytes())
        library = Path(folder) / f"loop{this_platform().ending}"
        compile_library(find_compiler(), source, library, this_platform())
        return ctypes.CDLL(str(library))
