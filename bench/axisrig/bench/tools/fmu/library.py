"""The plant library as the command line shows it."""

import os
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

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
from axisrig.fmus.watching import building
from axisrig.kernel.errors import UserError, near_files, nearest

_FEW = 6  # so many words are all shown, of more the nearest


def named(text: str) -> list[str]:
    """Return the models that a text means: by the full name, or by the last part of it."""
    return [name for name in MODELS if text in (name, name.rsplit(".", maxsplit=1)[-1])]


class Built(NamedTuple):
    """An FMU that was built: full name of the model, FMI version, and where it is."""

    model: str
    fmi: str
    path: Path


def build_models(
    model: str | None,
    fmi: Sequence[str] = ("3.0",),
    platforms: Sequence[str] = (),
    compiler: str | None = None,
) -> Iterator[Built]:
    """Build one model or all that the cache lacks, several at once; yield each in turn.

    model: full name, or its last part, or the file of a model of one's own. fmi: "3.0", "2.0" or
    both. platforms: words of FMI 3.0 or `all`, by default this one. compiler: cc, zig or omc.
    Raises UserError for an unknown word and when a build fails.
    """
    if model is not None and model.endswith(".mo"):
        if platforms or compiler or tuple(fmi) != ("3.0",):
            message = "a model of one's own is built as FMI 3.0 for this platform"
            raise UserError(message, value=model, hint="leave out --fmi, --platform, --compiler")
        if not Path(model).is_file():
            hint = near_files(Path(), model)
            raise UserError("there is no such model", file=model, hint=hint)
        from axisrig.bench.machine.fmu_files import own_fmu  # noqa: PLC0415 - takes long to load

        yield Built(Path(model).stem, "3.0", own_fmu(Path(model)))
        return
    names = list(MODELS) if model is None else named(model) or [model]
    for value, allowed, what in (
        *((name, MODELS, "the library has no such model") for name in names),
        *((version, FMI_VERSIONS, "no such FMI version") for version in fmi),
        *((name, ("all", *PLATFORMS), "no such platform") for name in platforms),
        (compiler or "cc", (*COMPILERS, "omc"), "no such compiler"),
    ):
        if value not in allowed:
            near = nearest(value, allowed) if len(allowed) > _FEW else []
            raise UserError(what, value=value, allowed=near or allowed)
    wanted = [(name, version) for version in dict.fromkeys(fmi) for name in names]
    yield from _built(wanted, chosen_platforms(platforms), compiler)


def chosen_platforms(words: Sequence[str]) -> list[str]:
    """Return the platforms that words of the command line mean; none for this one alone."""
    if "all" in words:
        return [p.name for p in PLATFORMS.values() if p.in_all]
    return list(dict.fromkeys(words))


def _built(
    wanted: Sequence[tuple[str, str]], platforms: Sequence[str], compiler: str | None
) -> Iterator[Built]:
    """Each in turn. Processes, since the Modelica compiler keeps the interpreter."""
    try:
        places = {
            (name, fmi): place_in_cache(name, None, fmi, platforms, compiler)
            for name, fmi in wanted
        }
    except BuildError as error:
        raise UserError(f"nothing can be built: {error}") from error
    missing = [one for one in wanted if not is_ours(places[one])]
    tasks = [[name, None, fmi, platforms, compiler] for name, fmi in missing]
    built = run_apart(ensure_built, tasks, jobs=os.cpu_count() or 1, is_fresh=False)
    for name, fmi in wanted:
        is_missing = (name, fmi) in missing
        if not is_missing:
            yield Built(name, fmi, places[name, fmi])
            continue
        with building(name):
            path = _next_of(built, name)
        yield Built(name, fmi, path)


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
