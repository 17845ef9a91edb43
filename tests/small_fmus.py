"""FMUs of models that are written for a test, built once for each content.

They are compiled without optimisation: nearly all time of a build is the C compiler's. What judges
the shipped models, their bits or their speed, builds them as users get them.
"""

import os
import time
from functools import cache
from pathlib import Path

from axisrig.fmus.build import build, cache_key

_FOLDER = Path(__file__).parents[1] / "out" / "tests" / "fmus"
_KEPT_S = 7 * 86_400


@cache
def _folder() -> Path:
    """Where they are kept; what no test has used for a week is deleted."""
    _FOLDER.mkdir(parents=True, exist_ok=True)
    for path in _FOLDER.iterdir():
        if path.stat().st_mtime < time.time() - _KEPT_S:
            path.unlink(missing_ok=True)
    return _FOLDER


def small_fmu(model: str, library: Path, step_s: float | None = None, fmi: str = "3.0") -> Path:
    """The FMU of a model of a test's own library; arguments as `build`. Raises BuildError."""
    key = cache_key(model, library, step_s, fmi, is_optimised=False)
    path = _folder() / f"{key[:24]}.fmu"
    if path.is_file():
        os.utime(path)
        return path
    return build(model, path, library, step_s, fmi, is_optimised=False)
