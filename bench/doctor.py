"""`axisrig doctor`: what this installation has and what it lacks."""

import platform
import shutil
import sys
from importlib import metadata
from importlib.util import find_spec
from pathlib import Path

import platformdirs

from fmus import MODELS, BuildError, ensure_built

PACKAGES = ("rumoca", "fmpy", "python-can", "canopen", "numpy", "scipy", "pandas", "pyarrow")


def examine() -> tuple[str, bool]:
    """Return the findings as text, and whether everything needed is there."""
    lines = [f"Python {platform.python_version()} on {platform.platform()}"]
    well = sys.version_info >= (3, 11)
    for name in PACKAGES:
        try:
            lines.append(f"ok    {name} {metadata.version(name)}")
        except metadata.PackageNotFoundError:
            lines.append(f"LACKS {name}: pip install -e . brings it")
            well = False
    compiler = shutil.which("cc")
    if compiler:
        lines.append(f"ok    C compiler {compiler}")
    elif find_spec("ziglang"):
        lines.append("ok    C compiler ziglang (no system cc)")
    else:
        lines.append("LACKS C compiler: install a system cc, or pip install -e '.[cc]'")
        well = False
    cache = Path(platformdirs.user_cache_dir("axisrig"))
    lines.append(f"info  built FMUs lie in {cache / 'fmus'}")
    for model in MODELS:
        try:
            lines.append(f"ok    {model}: {ensure_built(model).name}")
        except BuildError as error:
            lines.append(f"LACKS {model}: {error}")
            well = False
    lines.append("info  nothing here needs a network; only pip does, see README")
    return "\n".join(lines), well
