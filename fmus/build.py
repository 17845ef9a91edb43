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
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

import platformdirs

from fmus.compiler import (
    FLAGS,
    LINK,
    Compiler,
    compile_library,
    find_compiler,
    this_platform,
)
from fmus.errors import BuildError
from fmus.generate import SLAVES, Generated, generate, runtime_files
from fmus.ir import TARGET, compile_model

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


def ensure_built(model: str, cache_dir: Path | None = None, fmi: str = "3.0") -> Path:
    """The FMU of one of `MODELS` from the cache; built first when the cache has none.

    The name in the cache holds a hash of library, exporter, compilers and options.
    cache_dir: default is the folder `fmus` in the user's cache folder of axisrig. fmi: version of
    the standard, "3.0" or "2.0".
    Raises BuildError when the model is not known or cannot be built.
    """
    if model not in MODELS:
        raise BuildError(None, None, f"no model {model}; there are {', '.join(MODELS)}")
    folder = cache_dir or Path(platformdirs.user_cache_dir("axisrig")) / "fmus"
    path = folder / f"{model.rsplit('.', 1)[-1]}-{cache_key(model, fmi=fmi)[:24]}.fmu"
    return path if path.is_file() else build(model, path, fmi=fmi)


def build(
    model: str,
    path: Path,
    library: Path = LIBRARY,
    step_s: float | None = None,
    fmi: str = "3.0",
) -> Path:
    """Build the FMU of `model` of `library` into the file `path`, and return it.

    step_s: internal step of the integration, s; default by `models.csv`. Several processes may
    build the same file: each writes its own and puts it in place at once.
    Raises BuildError.
    """
    generated = generate(compile_model(model, library), _step_s(model, step_s), fmi)
    compiler, target = find_compiler(), this_platform()
    path.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix=".build-", dir=path.parent) as name:
        work = Path(name)
        sources = work / "sources"
        _write_sources(sources, generated)
        folder = target.folder if fmi == "3.0" else target.folder_fmi2
        binary = work / "binaries" / folder / f"{generated.identifier}{target.ending}"
        binary.parent.mkdir(parents=True)
        compile_library(compiler, sources / f"{generated.identifier}.c", binary)
        (work / "modelDescription.xml").write_text(generated.description, encoding="utf-8")
        packed = work / "packed"
        _pack(work, sorted(p for p in work.rglob("*") if p.is_file()), packed)
        packed.replace(path)
    return path


def _step_s(model: str, step_s: float | None) -> float:
    """The internal step to use."""
    if step_s is not None:
        return step_s
    return CATALOGUE[model].step_s if model in CATALOGUE else DEFAULT_STEP_S


def _write_sources(folder: Path, generated: Generated) -> None:
    """Write generated code, runtime and the FMI headers of the installed fmpy."""
    folder.mkdir()
    identifier = generated.identifier
    (folder / f"{identifier}.c").write_text(generated.source, encoding="utf-8")
    if generated.fmi == "3.0":  # 2.0 lists the sources in the model description
        (folder / "buildDescription.xml").write_text(
            _BUILD_DESCRIPTION.format(identifier=identifier), encoding="utf-8"
        )
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


def _pack(root: Path, files: Iterable[Path], packed: Path) -> None:
    """Write a zip archive whose bytes depend on the files alone."""
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        for file in files:
            entry = zipfile.ZipInfo(file.relative_to(root).as_posix(), _ZIP_DATE)
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.create_system = 3
            entry.external_attr = 0o644 << 16
            archive.writestr(entry, file.read_bytes())


def cache_key(
    model: str,
    library: Path = LIBRARY,
    step_s: float | None = None,
    compiler: Compiler | None = None,
    fmi: str = "3.0",
) -> str:
    """sha256 over everything that an FMU depends on."""
    exporter = Path(__file__).parent
    parts: dict[str, bytes] = {
        "model": model.encode(),
        "fmi": fmi.encode(),
        "step": repr(_step_s(model, step_s)).encode(),
        "rumoca": importlib.metadata.version("rumoca").encode(),
        "compiler": (compiler or find_compiler()).identity.encode(),
        "flags": " ".join((*FLAGS, *LINK)).encode(),
        "platform": this_platform().folder.encode(),
    }
    files = [
        *library.rglob("*.mo"),
        *exporter.glob("*.py"),
        *exporter.glob("*.csv"),
        *(path for path in TARGET.iterdir() if path.is_file()),
    ]
    for file in files:
        base = library.parent if file.is_relative_to(library) else exporter
        parts[f"file {file.relative_to(base).as_posix()}"] = file.read_bytes()
    parts.update({f"header {header.name}": header.read_bytes() for header in _headers(fmi)})
    return _digest(parts)


def _digest(parts: Mapping[str, bytes]) -> str:
    digest = hashlib.sha256()
    for name in sorted(parts):
        for text in (name.encode(), parts[name]):
            digest.update(len(text).to_bytes(8, "big"))
            digest.update(text)
    return digest.hexdigest()
