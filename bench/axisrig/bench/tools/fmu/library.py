"""The plant library as the command line shows it."""

import os
from collections.abc import Iterator, Sequence
from pathlib import Path

from axisrig.bench.campaign.processes import Died, run_apart
from axisrig.fmus import (
    CATALOGUE,
    COMPILERS,
    FMI_VERSIONS,
    MODELS,
    PLATFORMS,
    BuildError,
    ensure_built,
    is_ours,
    place_in_cache,
)
from axisrig.kernel.errors import UserError, nearest

_FEW = 6  # so many words are all shown, of more the nearest


def named(text: str) -> list[str]:
    """Return the models that a text means: by the full name, or by the last part of it."""
    return [name for name in MODELS if text in (name, name.rsplit(".", maxsplit=1)[-1])]


def build_models(
    model: str | None,
    fmi: str = "3.0",
    platforms: Sequence[str] = (),
    compiler: str | None = None,
) -> Iterator[str]:
    """Build one model or all that the cache lacks, several at once; yield a line for each.

    model: full name, or its last part. fmi: "3.0" or "2.0". platforms: words of FMI 3.0 or
    `all`, by default this one. compiler: cc, zig or omc.
    Raises UserError for an unknown word and when a build fails.
    """
    names = list(MODELS) if model is None else named(model) or [model]
    for value, allowed, what in (
        *((name, MODELS, "the library has no such model") for name in names),
        (fmi, FMI_VERSIONS, "no such FMI version"),
        *((name, ("all", *PLATFORMS), "no such platform") for name in platforms),
        (compiler or "cc", (*COMPILERS, "omc"), "no such compiler"),
    ):
        if value not in allowed:
            near = nearest(value, allowed) if len(allowed) > _FEW else []
            raise UserError(what, value=value, allowed=near or allowed)
    if "all" in platforms:
        platforms = [p.name for p in PLATFORMS.values() if p.in_all]
    yield from _built(names, fmi, platforms, compiler)


def _built(
    names: Sequence[str], fmi: str, platforms: Sequence[str], compiler: str | None
) -> Iterator[str]:
    """A line for each model. Processes, since the Modelica compiler keeps the interpreter."""
    try:
        places = {name: place_in_cache(name, None, fmi, platforms, compiler) for name in names}
    except BuildError as error:
        raise UserError(f"nothing can be built: {error}") from error
    missing = [name for name in names if not is_ours(places[name])]
    tasks = [[name, None, fmi, platforms, compiler] for name in missing]
    building = run_apart(ensure_built, tasks, jobs=os.cpu_count() or 1, is_fresh=False)
    for name in names:
        yield f"{name}: {_next_of(building, name) if name in missing else places[name]}"


def _next_of(building: Iterator[Path | Died], name: str) -> Path:
    """The next FMU that was built. Raises UserError when its build fails."""
    try:
        built = next(building)
    except BuildError as error:
        raise UserError(f"{name} cannot be built: {error}") from error
    if isinstance(built, Died):
        raise UserError(f"{name} cannot be built: {built.reason}")
    return built


def listing() -> str:
    """Return the models with their internal steps, whether they are built, and their titles."""
    width = max(len(name) for name in MODELS)
    lines = []
    places: set[str] = set()
    for row in CATALOGUE.values():
        try:
            place = place_in_cache(row.name)
            places.add(f"built FMUs are in {place.parent}")
            built = "built" if is_ours(place) else "-"
        except BuildError as error:
            places.add(f"nothing can be built: {error}")
            built = "?"
        lines.append(f"{row.name:<{width}}  {row.step_s * 1e6:5g} us  {built:<5}  {row.title}")
    return "\n".join([*lines, "", *sorted(places)])
