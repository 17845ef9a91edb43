"""From a Modelica model to the compiler's solve representation, as plain Python data.

Source: behaviour of rumoca 0.10.2; the layout is pinned by `SCHEMA_VERSION`.
"""

import json
import os
import pickle
import re
import subprocess
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path
from typing import Any

import rumoca

from axisrig.fmus.reading.classes import class_names, used_classes
from axisrig.fmus.reading.errors import BuildError
from axisrig.fmus.reading.target import TARGET

SCHEMA_VERSION = 71

# The compiler prints mappings nearly as JSON: strings are escaped as in Rust, some words differ.
# Stretches that are JSON as they are come first and as long as possible: there are millions of
# tokens, and few to change.
_TOKEN = re.compile(
    r'(?P<json>(?:"[^"\\]*+"|[^"A-Za-z]++|\b(?:true|false)\b|(?<=\d)e(?=[-+\d]))++)'
    r'|"(?:[^"\\]|\\.)*"|[A-Za-z]+'
)
_ALONE = "from axisrig.fmus.reading.ir import compile_alone; compile_alone()"
_compiled_in: set[int] = set()
"""The processes that have compiled, of this one and those that it was forked from."""
_WORDS = {"none": "null", "undefined": "null", "inf": "Infinity", "nan": "NaN", "NaN": "NaN"}


@dataclass(frozen=True)
class Source:
    """A place in the library: path relative to the folder that holds the library, line from 1."""

    file: str
    line: int

    def __str__(self) -> str:
        return f"{self.file}:{self.line}"


@dataclass(frozen=True)
class Ir:
    """What the compiler reports about one model.

    solve: programs and layout. dae: variables with their attributes. flat: the flattened class, for
    what the others do not contain: its description and the names of types. files: text of each
    source file by the compiler's file number. root: the folder that holds the library.
    """

    model: str
    solve: Mapping[str, Any]
    dae: Mapping[str, Any]
    flat: Mapping[str, Any]
    files: Mapping[int, tuple[Path, str]]
    root: Path

    def enumeration_of(self, variable: str) -> tuple[str, tuple[str, ...]] | None:
        """Name and literals, in their order, of the type of an enumeration variable.

        None when the compiler does not say which type it is.
        """
        type_name = self.flat["variable_type_names"].get(variable, "")
        types: dict[str, dict[int, str]] = {}
        for literal, ordinal in self.flat["enum_literal_ordinals"].items():
            owner, _, name = literal.rpartition(".")
            if owner == type_name or owner.endswith(f".{type_name}"):
                types.setdefault(owner, {})[ordinal] = name.strip("'")
        found = {tuple(names[n] for n in sorted(names)) for names in types.values()}
        return (max(types, key=len), found.pop()) if len(found) == 1 else None

    def place(self, span: Mapping[str, int] | None) -> Source | None:
        """Where a span of the compiler is; None when it is not from a file."""
        if span is None or span.get("source") not in self.files:
            return None
        path, text = self.files[span["source"]]
        name = path.relative_to(self.root).as_posix() if path.is_relative_to(self.root) else path
        prefix = text.encode()[: span["start"]]
        return Source(str(name), prefix.count(b"\n") + 1)

    def error(self, span: Mapping[str, int] | None, message: str) -> BuildError:
        """A BuildError at a span."""
        place = self.place(span)
        if place is None:
            return BuildError(self.model, None, message)
        return BuildError(place.file, place.line, message)


def compile_model(model: str, library: Path, roots: Sequence[Path] = ()) -> Ir:
    """Compile `model` (full name) of the library in folder `library`, or of a file.

    roots: folders of further libraries that it may use. Raises BuildError when the compiler refuses
    the model or its representation is a different one. The compiler has threads, which a fork does
    not take along and which it would wait for: in a process that was forked from one that has
    compiled, a process of its own compiles.
    """
    if _compiled_in - {os.getpid()}:
        return _compiled_apart(model, library, roots)
    _compiled_in.add(os.getpid())
    entry = library / "package.mo" if library.is_dir() else library
    if not entry.is_file():
        raise BuildError(entry, None, "there is no Modelica library")
    try:
        compiled = rumoca.Session([str(root) for root in roots]).load(str(entry), model=model)
        text = compiled.codegen(str(TARGET)).files[0].content
        source_map = json.loads(compiled.to_json("dae"))["source_map"]["files"]
        flat = json.loads(compiled.to_json("flat"))
    except BaseException as error:
        # A panic of the compiler comes as an exception outside Exception.
        panic = type(error).__module__ == "pyo3_runtime"
        if panic or isinstance(error, rumoca.RumocaError | RuntimeError):
            raise _refused(error, model, library, roots) from error
        raise
    data = json.loads(_TOKEN.sub(_as_json, text))
    found = data["solve"]["schema_version"]
    if found != SCHEMA_VERSION:
        raise BuildError(
            None, None, f"rumoca {rumoca.version()} writes schema {found}, not {SCHEMA_VERSION}"
        )
    files = {number: (Path(name).resolve(), text) for number, name, text in source_map}
    root = (library if library.is_dir() else entry).resolve().parent
    return Ir(model, data["solve"], data["dae"], flat, files, root)


def _compiled_apart(model: str, library: Path, roots: Sequence[Path]) -> Ir:
    """Compile in a process that is started anew. Raises BuildError as `compile_model` does."""
    task = pickle.dumps((model, library, tuple(roots)))
    ended = subprocess.run(
        [sys.executable, "-c", _ALONE], input=task, stdout=subprocess.PIPE, check=False
    )
    if ended.returncode:
        raise BuildError(None, None, f"the compiler ended with {ended.returncode}")
    found = pickle.loads(ended.stdout)
    if isinstance(found, BuildError):
        raise found
    assert isinstance(found, Ir)
    return found


def compile_alone() -> None:
    """Compile what standard input asks for and write what came of it: `_compiled_apart`."""
    found: Ir | BuildError
    try:
        found = compile_model(*pickle.load(sys.stdin.buffer))
    except BuildError as error:
        found = error
    pickle.dump(found, sys.stdout.buffer)


def _as_json(match: re.Match[str]) -> str:
    token = match.group(0)
    if match.lastgroup == "json":
        return token
    if token.startswith('"'):
        return re.sub(r"\\u\{([0-9a-f]+)\}", lambda m: f"\\u{int(m.group(1), 16):04x}", token)
    return _WORDS.get(token, token)


def _refused(error: BaseException, model: str, library: Path, roots: Sequence[Path]) -> BuildError:
    """Find the place that the compiler complains about; it names it in its text or not at all."""
    text = str(error)
    for file in sorted(library.rglob("*.mo")) if library.is_dir() else _named_in(text, library):
        for diagnostic in rumoca.validate(str(file)):
            place = re.search(r"\[[^\]\s]+:(\d+):\d+\]", diagnostic.message)
            if place and diagnostic.level == "error":
                message = re.search(r"× (.+)", diagnostic.message)
                what = message.group(1) if message else "syntax error"
                return BuildError(_short(file, library), int(place.group(1)), what)
    if library.is_file() and (other := _other_class(model, library)):
        return other
    first = text.splitlines()[0] if text else type(error).__name__
    found = re.search(r" ?\[([^\]\s]+\.mo):(\d+):\d+\]", text)
    if found and (file := Path(found.group(1))).is_relative_to(library):
        return BuildError(_short(file, library), int(found.group(2)), first.replace(found[0], ""))
    names = re.findall(r"[`']([\w.\[\]]+)[`']", first)
    file, line = _place_of(names, model, library)
    if names and "does not exist" in first:
        first += _hint_at(names[0], roots)
    return BuildError(_short(file, library), line, first)


def _named_in(text: str, model: Path) -> list[Path]:
    """The file of a model, and those beside it that the compiler names."""
    return [model, *(file for file in _beside(model) if str(file.resolve()) in text)]


def _beside(model: Path) -> list[Path]:
    """The files that the file of a model may use: those in its folder, without itself."""
    return [file for file in sorted(model.parent.glob("*.mo")) if file.name != model.name]


def _hint_at(name: str, roots: Sequence[Path]) -> str:
    """Say what may help where a class of a library is not found."""
    known = [
        ".".join((root.name, *file.relative_to(root).with_suffix("").parts))
        for root in roots
        for file in sorted(root.rglob("*.mo"))
    ]
    if name in known:  # the compiler loads the libraries that the first file names
        return f"; write `import {name.partition('.')[0]};` into the model"
    near = get_close_matches(name, known, 3)
    return f"; did you mean {' or '.join(near)}" if near else ""


def _other_class(model: str, file: Path) -> BuildError | None:
    """A file holds one model of its name; find one that holds another class instead."""
    names = class_names(file.read_text(encoding="utf-8"))
    if not names or model in names:
        return None
    wanted = f"rename the class to {model}, or the file to {names[0]}.mo"
    return BuildError(file.name, None, f"the file holds the class {names[0]}; {wanted}")


def _place_of(names: Sequence[str], model: str, library: Path) -> tuple[Path, int | None]:
    """Where one of the names is in a class that the model uses; else where the model begins."""
    home = _file_of(model, library)
    if library.is_dir():
        others = [file for file in sorted(library.rglob("*.mo")) if file != home]
    else:
        others = _beside(library)
    files = dict(enumerate([home, *others]))
    texts = {n: file.read_text(encoding="utf-8", errors="replace") for n, file in files.items()}
    bodies = list(used_classes(texts, model))
    words = [name.rpartition(".")[2].partition("[")[0] for name in names]
    for word in words:
        for body in bodies:
            found = re.search(rf"\b{re.escape(word)}\b", body.text)
            if found:
                text = texts[body.number][: body.offset + found.start()]
                return files[body.number], text.count("\n") + 1
    if bodies:
        text = texts[bodies[0].number][: bodies[0].offset]
        return files[bodies[0].number], text.count("\n") + 1
    return home, None


def _short(file: Path, library: Path) -> str:
    """A file as it is named in messages: from the folder that holds the library."""
    return file.relative_to(library.parent).as_posix()


def _file_of(model: str, library: Path) -> Path:
    """The file that holds a class of the library: its own, or that of a package around it."""
    parts = model.split(".")[1:]
    while parts and library.is_dir():
        file = library.joinpath(*parts)
        for candidate in (file.with_suffix(".mo"), file / "package.mo"):
            if candidate.is_file():
                return candidate
        parts.pop()
    return library / "package.mo" if library.is_dir() else library
