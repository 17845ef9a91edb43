"""`axisrig doctor`: what this installation has and what it lacks."""

import platform
import shutil
import sys
from importlib import metadata
from importlib.util import find_spec
from pathlib import Path

import platformdirs

from axisrig.bench.bus.can.hardware import SIMULATED, interface_names, known_interfaces, usable
from axisrig.bench.campaign.leftovers import leftovers
from axisrig.bench.campaign.results.build_info import build_word, sources_sha256
from axisrig.fmus import MODELS, BuildError, ensure_built

PACKAGES = ("rumoca", "fmpy", "python-can", "canopen", "numpy", "scipy", "pandas", "pyarrow")


def examine() -> tuple[str, bool]:
    """Return the findings as text, and whether everything needed is there.

    Leftovers of an older axisrig are named; they are no lack.
    """
    lines = [f"Python {platform.python_version()} on {platform.platform()}"]
    lines.append(f"info  axisrig runs {build_word()}, sources {sources_sha256()}")
    well = sys.version_info >= (3, 11)
    for name in PACKAGES:
        try:
            lines.append(f"ok    {name} {metadata.version(name)}")
        except metadata.PackageNotFoundError:
            lines.append(f"LACKS {name}: pip install axisrig brings it")
            well = False
    found, has_compiler = _compilers()
    lines += found
    well = well and has_compiler
    cache = Path(platformdirs.user_cache_dir("axisrig"))
    lines.append(f"info  built FMUs are in {cache / 'fmus'}")
    for model in MODELS:
        try:
            lines.append(f"ok    {model}: {ensure_built(model).name}")
        except BuildError as error:
            lines.append(f"LACKS {model}: {error}")
            well = False
    lines += _interfaces()
    lines += [f"OLD   {text}" for text in leftovers()]
    lines.append("info  nothing here needs a network; only pip does, see README")
    return "\n".join(lines), well


def _interfaces() -> list[str]:
    """Which CAN interfaces have their software here; none is opened."""
    lines = []
    for name, known in known_interfaces().items():
        lack = usable(name)
        if lack is None:
            lines.append(f"ok    CAN interface {name}: {known.about}")
        else:
            needs = f"; needs: {known.needs}" if known.needs else ""
            lines.append(f"info  CAN interface {name} not here: {lack}{needs}")
    others = [n for n in interface_names() if n not in known_interfaces() and n != SIMULATED]
    there = [name for name in others if usable(name) is None]
    lines.append(
        f"info  further CAN interfaces, drivers not looked for: {', '.join(there) or 'none'}"
    )
    return lines


def _compilers() -> tuple[list[str], bool]:
    """What can build FMUs, and whether anything can."""
    cc, omc, has_zig = shutil.which("cc"), shutil.which("omc"), bool(find_spec("ziglang"))
    lines = []
    if cc:
        lines.append(f"ok    C compiler {cc}")
    if has_zig:
        version = metadata.version("ziglang")
        lines.append(f"ok    C compiler ziglang {version}, also for other platforms")
    else:
        pip = "pip install 'axisrig[cc]'"
        need = "" if cc else "install a system cc, or "
        word = "info " if cc else "LACKS"
        what = "FMUs for other platforms need ziglang" if cc else "C compiler"
        lines.append(f"{word} {what}: {need}{pip}")
    if omc:
        lines.append(f"info  OpenModelica {omc} (fmu build --compiler omc)")
    return lines, bool(cc) or has_zig
