"""Builds the plant FMUs and keeps them in a cache.

`ensure_built("AxisRig.Drives.ServoAxis")` gives the path of an FMU that is up to date.
"""

import csv
import hashlib
import importlib.metadata
import importlib.util
import shutil
import tempfile
import zipfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

import platformdirs

from axisrig.fmus.compiler import (
    COMPILERS,
    LINK,
    PLATFORMS,
    ZIG_FLAGS,
    Compiler,
    Platform,
    compile_library,
    compiler_for,
    flags,
    this_platform,
    universal_library,
)
from axisrig.fmus.openmodelica import build_with_omc, omc_identity
from axisrig.fmus.reading.errors import BuildError
from axisrig.fmus.reading.target import SLAVES, TARGET, runtime_files
from axisrig.fmus.shipped import Shipped, is_whole, sha256_of, shipped
from axisrig.fmus.sources import Stamp, files_below, files_named, hash_of
from axisrig.fmus.watching import building

if TYPE_CHECKING:
    from axisrig.fmus.writing.generate import Generated

LIBRARY = Path(__file__).parent / "AxisRig"
MODELS_FILE = Path(__file__).parent / "models.csv"
DEFAULT_STEP_S = 50e-6


@dataclass(frozen=True)
class Model:
    """A row of `models.csv`: what the library offers as an FMU.

    name: full Modelica name. step_s: internal step of the integration, s. title: for lists.
    """

    name: str
    step_s: float
    title: str


def read_models() -> dict[str, Model]:
    """The models of the library by full name, in the order of the file."""
    with MODELS_FILE.open(encoding="utf-8", newline="") as file:
        rows = [Model(r["model"], float(r["step_s"]), r["title"]) for r in csv.DictReader(file)]
    return {row.name: row for row in rows}


CATALOGUE: Mapping[str, Model] = read_models()
MODELS: tuple[str, ...] = tuple(CATALOGUE)

FMI_VERSIONS: tuple[str, ...] = tuple(SLAVES)
HEADERS: Mapping[str, tuple[str, ...]] = {
    "3.0": ("fmi3Functions.h", "fmi3FunctionTypes.h", "fmi3PlatformTypes.h"),
    "2.0": ("fmi2Functions.h", "fmi2FunctionTypes.h", "fmi2TypesPlatform.h"),
}
NO_RUMOCA = "the Modelica compiler rumoca is not installed: pip install 'axisrig[models]'"
_ZIP_DATE = (1980, 1, 1, 0, 0, 0)
_BUILD_DESCRIPTION = """<?xml version="1.0" encoding="UTF-8"?>
<fmiBuildDescription fmiVersion="3.0">
  <BuildConfiguration modelIdentifier="{identifier}">
    <SourceFileSet language="C11">
      <SourceFile name="{identifier}.c"/>
    </SourceFileSet>
  </BuildConfiguration>
</fmiBuildDescription>
"""


def ensure_built(
    model: str,
    cache_dir: Path | None = None,
    fmi: str = "3.0",
    platforms: Sequence[str] = (),
    compiler: str | None = None,
) -> Path:
    """The FMU of one of `MODELS` from the cache; built when the cache has none, or a damaged one.

    With nothing but its name asked for, the one that came with the wheel serves (`shipped.py`).
    Arguments as `place_in_cache`. Raises BuildError when the model cannot be built.
    """
    path = place_in_cache(model, cache_dir, fmi, platforms, compiler)
    if not is_ours(path, path.parent):
        with building(model):
            build(model, path, fmi=fmi, platforms=platforms, compiler=compiler)
        record = _record(path, path.parent)
        record.parent.mkdir(exist_ok=True)
        record.touch()
    return path


def ensure_own_built(source: Path, cache_dir: Path | None = None) -> Path:
    """The FMU of a model in a file of its own from the cache, built when something has changed.

    The model has the name of the file; it may use models in files beside it and those of the
    library. cache_dir: as `place_in_cache`. Raises BuildError when it cannot be built.
    """
    if not source.is_file():
        raise BuildError(source, None, "there is no such model")
    key = cache_key(source.stem, source)
    path = _cache(cache_dir) / f"{source.stem}-{key[:24]}.fmu"
    if not is_ours(path, path.parent):
        with building(source.name):
            build(source.stem, path, source)
        record = _record(path, path.parent)
        record.parent.mkdir(exist_ok=True)
        record.touch()
    return path


def is_ours(path: Path, cache_dir: Path | None = None) -> bool:
    """Return whether the file at `path` is byte for byte an FMU that `ensure_built` has made.

    The place does not matter: the cache keeps the hash of each one. cache_dir: as `place_in_cache`.
    """
    if not path.is_file():
        return False
    digest = sha256_of(path)
    if any(one.sha256 == digest for one in shipped().values()):
        return True
    return (_cache(cache_dir) / "sha256" / digest).is_file()


def _record(path: Path, folder: Path) -> Path:
    """The file in a cache that says: an FMU with these bytes was built."""
    return folder / "sha256" / sha256_of(path)


def _cache(cache_dir: Path | None) -> Path:
    return cache_dir or Path(platformdirs.user_cache_dir("axisrig")) / "fmus"


def place_in_cache(
    model: str,
    cache_dir: Path | None = None,
    fmi: str = "3.0",
    platforms: Sequence[str] = (),
    compiler: str | None = None,
) -> Path:
    """Where the cache has the FMU of one of `MODELS`, or will have it.

    The name holds a hash of library, exporter, compilers and options.
    cache_dir: default is the folder `fmus` in the user's cache folder of axisrig. fmi: version of
    the standard, "3.0" or "2.0". platforms: words of FMI 3.0 such as x86_64-linux, by default this
    one. compiler: "cc", "zig" or "omc"; by default the system's cc, and zig for other platforms.
    With defaults alone it is the shipped one, where there is one of these sources.
    Raises BuildError when the model or an option is not known.
    """
    if model not in MODELS:
        raise BuildError(None, None, f"no model {model}; there are {', '.join(MODELS)}")
    one = shipped_fmu(model) if (cache_dir, fmi, compiler) == (None, "3.0", None) else None
    if one is not None and not platforms:
        return one.path
    key = cache_key(model, fmi=fmi, platforms=platforms, compiler=compiler)
    return _cache(cache_dir) / f"{model.rsplit('.', 1)[-1]}-{key[:24]}.fmu"


def shipped_fmu(model: str) -> Shipped | None:
    """Return the FMU of a model that came with the wheel; None where it is of other sources."""
    one = shipped().get(model)
    if one is None or one.key != source_key(model) or not is_whole(one):
        return None
    return one


def build(
    model: str,
    path: Path,
    library: Path = LIBRARY,
    step_s: float | None = None,
    fmi: str = "3.0",
    platforms: Sequence[str] = (),
    compiler: str | None = None,
    is_optimised: bool = True,
) -> Path:
    """Build the FMU of `model` of `library` into the file `path`, and return it.

    library: a folder, or the file of a model, which may use the library of axisrig.
    step_s: internal step of the integration, s; default by `models.csv`. fmi, platforms, compiler
    as `place_in_cache`. is_optimised: False for a build in a third of the time, and a slower FMU;
    omc ignores it. Several processes may build the same file: each writes its own and puts it in
    place at once.
    Raises BuildError.
    """
    _check_options(fmi, compiler)
    targets = _targets(platforms, fmi)
    if compiler == "omc":
        _refuse_foreign(targets)
        return build_with_omc(model, path, library, fmi)
    chosen = compiler_for(targets, compiler)
    # What builds is loaded where it builds: most runs find their FMUs in the cache
    if importlib.util.find_spec("rumoca") is None:
        raise BuildError(None, None, NO_RUMOCA)
    from axisrig.fmus.reading.ir import compile_model
    from axisrig.fmus.writing.generate import generate

    generated = generate(
        compile_model(model, library, _roots(library)), _step_s(model, step_s), fmi
    )
    path.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix=".build-", dir=path.parent) as place:
        work = Path(place)
        sources = work / "sources"
        _write_sources(sources, generated)
        source, binaries = sources / f"{generated.identifier}.c", work / "binaries"
        _compile(chosen, targets, source, binaries, fmi, is_optimised)
        _write(work / "modelDescription.xml", generated.description)
        for name, content in generated.others.items():
            (work / name).parent.mkdir(parents=True, exist_ok=True)
            (work / name).write_bytes(content)
        packed = work / "packed"
        _pack(work, packed)
        packed.replace(path)
    return path


def _check_options(fmi: str, compiler: str | None) -> None:
    for value, allowed, what in (
        (fmi, FMI_VERSIONS, "FMI version"),
        (compiler or "cc", (*COMPILERS, "omc"), "compiler"),
    ):
        if value not in allowed:
            message = f"{what} {value} is not known; there are {', '.join(allowed)}"
            raise BuildError(None, None, message)


def _targets(names: Sequence[str], fmi: str) -> list[Platform]:
    """The platforms to build for. Raises BuildError for one that is not known."""
    for name in names:
        if name not in PLATFORMS:
            message = f"platform {name} is not known; there are {', '.join(PLATFORMS)}"
            raise BuildError(None, None, message)
    targets = [PLATFORMS[name] for name in dict.fromkeys(names)] or [this_platform()]
    # One folder of FMI 2.0 is for both machines of macOS: it gets the library of both.
    folders = {target.folder(fmi) for target in targets}
    if fmi == "2.0" and targets != [this_platform()]:
        targets = [p for p in PLATFORMS.values() if p.fmi2_folder in folders]
    return targets


def _refuse_foreign(targets: Sequence[Platform]) -> None:
    """OpenModelica builds for this platform alone."""
    if list(targets) != [this_platform()]:
        raise BuildError(None, None, f"OpenModelica builds for {this_platform().name} only")


def _compile(
    compiler: Compiler,
    targets: Sequence[Platform],
    source: Path,
    binaries: Path,
    fmi: str,
    is_optimised: bool,
) -> None:
    """Compile for each platform; what shares a folder becomes one universal library."""
    folders: dict[str, list[Platform]] = {}
    for target in targets:
        folders.setdefault(target.folder(fmi), []).append(target)
    for folder, sharing in folders.items():
        library = binaries / folder / f"{source.stem}{sharing[0].ending}"
        if len(sharing) == 1:
            compile_library(compiler, source, library, sharing[0], is_optimised)
            continue
        thin = [library.with_suffix(f".{target.name}") for target in sharing]
        for part, target in zip(thin, sharing, strict=True):
            compile_library(compiler, source, part, target, is_optimised)
        universal_library(thin, library)
        for part in thin:
            part.unlink()


def _step_s(model: str, step_s: float | None) -> float:
    """The internal step to use."""
    if step_s is not None:
        return step_s
    return CATALOGUE[model].step_s if model in CATALOGUE else DEFAULT_STEP_S


def _write_sources(folder: Path, generated: "Generated") -> None:
    """Write generated code, runtime and the FMI headers of the installed fmpy."""
    folder.mkdir()
    identifier = generated.identifier
    _write(folder / f"{identifier}.c", generated.source)
    if generated.fmi == "3.0":  # 2.0 lists the sources in the model description
        _write(folder / "buildDescription.xml", _BUILD_DESCRIPTION.format(identifier=identifier))
    for name in runtime_files(generated.fmi):
        shutil.copyfile(TARGET / name, folder / name)
    for header in _headers(generated.fmi):
        shutil.copyfile(header, folder / header.name)


def _headers(fmi: str) -> list[Path]:
    """The FMI headers; fmpy is only located, not loaded."""
    found = importlib.util.find_spec("fmpy")
    if found is None or found.origin is None:
        raise BuildError(None, None, "the package fmpy is not installed")
    folder = Path(found.origin).parent / "c-code"
    return [folder / name for name in HEADERS[fmi]]


def _write(file: Path, text: str) -> None:
    """Write a text that is the same on every system."""
    file.write_text(text, encoding="utf-8", newline="\n")


def _pack(root: Path, packed: Path) -> None:
    """Write a zip archive whose bytes depend on the files below `root` alone.

    They are stored as they are: what compression makes of them depends on the library that does it.
    """
    files = {p.relative_to(root).as_posix(): p for p in root.rglob("*") if p.is_file()}
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_STORED) as archive:
        for name in sorted(files):
            entry = zipfile.ZipInfo(name, _ZIP_DATE)
            entry.create_system = 3
            entry.external_attr = 0o644 << 16
            archive.writestr(entry, files[name].read_bytes())


def cache_key(
    model: str,
    library: Path = LIBRARY,
    step_s: float | None = None,
    fmi: str = "3.0",
    platforms: Sequence[str] = (),
    compiler: str | None = None,
    is_optimised: bool = True,
) -> str:
    """sha256 over everything that an FMU depends on. Arguments as `build`."""
    _check_options(fmi, compiler)
    targets = _targets(platforms, fmi)
    is_omc = compiler == "omc"
    identity = omc_identity() if is_omc else compiler_for(targets, compiler).identity
    parts: dict[str, bytes] = {
        "model": model.encode(),
        "fmi": fmi.encode(),
        "step": repr(_step_s(model, step_s)).encode(),
        "rumoca": _rumoca().encode(),
        "compiler": identity.encode(),
        "flags": " ".join((*flags(is_optimised), *ZIG_FLAGS, *LINK)).encode(),
        "platforms": " ".join(target.name for target in targets).encode(),
        "library": library.name.encode() + hash_of(_models(library)),
        "roots": b"".join(hash_of(_models(root)) for root in _roots(library)),
        **_exporter(),
        "headers": hash_of(files_named(_headers(fmi))),
    }
    return _digest(parts)


def source_key(model: str) -> str:
    """sha256 over the sources that the shipped FMU of a model depends on, without the tools."""
    parts = {
        "model": model.encode(),
        "step": repr(_step_s(model, None)).encode(),
        "platform": this_platform().name.encode(),
        "library": hash_of(_models(LIBRARY)),
        **_exporter(),
    }
    return _digest(parts)


def _exporter() -> dict[str, bytes]:
    return {
        "exporter": hash_of(files_below(Path(__file__).parent, (".py", ".csv"))),
        "version": _version().encode(),
        "target": hash_of(files_below(TARGET, ("",))),
    }


def _roots(library: Path) -> tuple[Path, ...]:
    """Libraries that a library may use."""
    return (LIBRARY,) if library.is_file() else ()


def _models(library: Path) -> tuple[Stamp, ...]:
    """The files of a library, or of a model and what is beside it."""
    return files_below(library if library.is_dir() else library.parent, (".mo",))


@cache
def _version() -> str:
    """The version of axisrig, which the model descriptions of its own library name."""
    return importlib.metadata.version("axisrig")


@cache
def _rumoca() -> str:
    """The version of the Modelica compiler; empty without one."""
    try:
        return importlib.metadata.version("rumoca")
    except importlib.metadata.PackageNotFoundError:
        return ""


def _digest(parts: Mapping[str, bytes]) -> str:
    digest = hashlib.sha256()
    for name in sorted(parts):
        for text in (name.encode(), parts[name]):
            digest.update(len(text).to_bytes(8, "big"))
            digest.update(text)
    return digest.hexdigest()
