"""`axisrig doctor`: what this installation has and what it lacks."""

import platform
import shutil
from collections.abc import Iterator
from importlib import metadata
from importlib.util import find_spec
from pathlib import Path

import platformdirs

from axisrig.bench.bus.can.hardware import SIMULATED, interface_names, known_interfaces, usable
from axisrig.bench.campaign.older_packages import leftovers
from axisrig.bench.campaign.results.build_info import build_word, is_compiled, sources_sha256
from axisrig.fmus import MODELS, BuildError, ensure_built, is_ours, place_in_cache, shipped_fmu

PACKAGES = ("fmpy", "python-can", "canopen", "numpy", "scipy", "pandas", "pyarrow")


LACK = "LACKS "
"""Begin of the line of something needed that is not there."""


def examine(*, is_building: bool = False) -> Iterator[str]:
    """Yield the findings, a line each as soon as it is found; a lack begins with `LACK`.

    is_building: build the FMUs of the library that are not there. Leftovers of an older axisrig are
    named; they are no lack.
    """
    yield f"Python {platform.python_version()} on {platform.platform()}"
    yield f"info  axisrig runs {build_word()}, sources {sources_sha256()}"
    if not is_compiled():
        yield (
            "info  that is the slower build, for work on axisrig itself: the wheel of `make wheel`,"
            " and `make fast`, run the same plans compiled (docs/performance.md)"
        )
    for name in PACKAGES:
        try:
            yield f"ok    {name} {metadata.version(name)}"
        except metadata.PackageNotFoundError:
            yield f"{LACK}{name}: pip install axisrig brings it"
    has_all = all(shipped_fmu(model) is not None for model in MODELS)
    yield _modelica(is_needed=not has_all)
    yield from _compilers(is_needed=not has_all)
    cache = Path(platformdirs.user_cache_dir("axisrig"))
    yield f"info  built FMUs are in {cache / 'fmus'}"
    yield from _models(is_building=is_building)
    yield from _interfaces()
    yield from (f"OLD   {text}" for text in leftovers())
    yield "info  nothing here needs a network; only pip does, see README"


def _models(*, is_building: bool) -> Iterator[str]:
    """Say which FMUs of the library are built."""
    missing = 0
    for model in MODELS:
        try:
            path = ensure_built(model) if is_building else place_in_cache(model)
            if is_building or is_ours(path):
                one = shipped_fmu(model)
                came = ", shipped" if one is not None and one.path == path else ""
                yield f"ok    {model}: {path.name}{came}"
            else:
                missing += 1
                yield f"info  {model}: not built; that is done where a run needs it"
        except BuildError as error:
            yield f"{LACK}{model}: {error}"
    if missing:
        what, them = ("FMU is", "it") if missing == 1 else ("FMUs are", "them")
        yield f"info  {missing} {what} not built; axisrig doctor --build builds {them} now"


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


def _modelica(*, is_needed: bool) -> str:
    """Say whether models can be translated; is_needed as `_compilers`."""
    try:
        return f"ok    rumoca {metadata.version('rumoca')}"
    except metadata.PackageNotFoundError:
        word = LACK.strip() if is_needed else "info "
        return f"{word} rumoca, for models: pip install 'axisrig[models]'"


def _compilers(*, is_needed: bool) -> list[str]:
    """What can build FMUs. is_needed: not all FMUs of the library came with the installation."""
    cc, omc, has_zig = shutil.which("cc"), shutil.which("omc"), bool(find_spec("ziglang"))
    lack = LACK.strip() if is_needed else "info "
    lines = []
    if cc:
        lines.append(f"ok    C compiler {cc}")
    if has_zig:
        version = metadata.version("ziglang")
        lines.append(f"ok    C compiler ziglang {version}, also for other platforms")
    else:
        pip = "pip install 'axisrig[cc]'"
        need = "" if cc else "install a system cc, or "
        word = "info " if cc else lack
        what = "FMUs for other platforms need ziglang" if cc else "C compiler"
        lines.append(f"{word} {what}: {need}{pip}")
    if omc:
        lines.append(f"info  OpenModelica {omc} (fmu build --compiler omc)")
    return lines
