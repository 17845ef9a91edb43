"""Where a model is wrong that the compiler refuses: its file and line, whatever the compiler says.

A stand-in of the compiler raises one text; what it finds wrong in a file are its diagnostics, as
rumoca 0.10.2 writes them.
"""

import io
import os
import pickle
import subprocess
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.fmus.build import LIBRARY
from axisrig.fmus.reading import ir
from axisrig.fmus.reading.errors import BuildError

Diagnostics = Mapping[str, Sequence[tuple[str, str]]]


def written(folder: Path, **texts: str) -> Path:
    folder.mkdir(exist_ok=True)
    for name, text in texts.items():
        (folder / f"{name}.mo").write_text(text, encoding="utf-8")
    return folder


@pytest.fixture
def refused(monkeypatch: pytest.MonkeyPatch) -> Callable[..., BuildError]:
    """The error of a model that the compiler refuses with a text and diagnostics by file."""

    def make(
        model: str, library: Path, text: str, diagnosed: Diagnostics, *roots: Path
    ) -> BuildError:
        def session(_roots: list[str]) -> Any:
            raise ir.rumoca.RumocaError(text)

        def validate(file: str) -> list[Any]:
            found = diagnosed.get(Path(file).name, ())
            return [SimpleNamespace(level=level, message=words) for level, words in found]

        monkeypatch.setattr(ir, "_compiled_in", set())
        monkeypatch.setattr(ir.rumoca, "Session", session)
        monkeypatch.setattr(ir.rumoca, "validate", validate)
        with pytest.raises(BuildError) as caught:
            ir.compile_model(model, library, roots)
        return caught.value

    return make


def at(file: str, line: int, words: str = "unexpected `k`") -> str:
    return f"EP001\n\n  × {words}\n   ╭─[{file}:{line}:8]\n 1 │ model M\n"


@pytest.mark.parametrize(
    ("diagnosed", "line", "message"),
    [
        ([("error", at("M.mo", 5))], 5, "unexpected `k`"),
        # What is only warned of is no reason, wherever it is
        ([("warning", at("M.mo", 2, "odd")), ("error", at("M.mo", 5))], 5, "unexpected `k`"),
        ([("error", at("M.mo", 5)), ("warning", at("M.mo", 2))], 5, "unexpected `k`"),
        ([("error", at("M.mo", 5)), ("error", at("M.mo", 7))], 5, "unexpected `k`"),
        ([("error", "no place"), ("error", at("M.mo", 7, "odd"))], 7, "odd"),
        ([("error", "without a cross [M.mo:6:1]")], 6, "syntax error"),
    ],
)
def test_the_first_error_with_a_place_is_the_reason(
    tmp_path: Path, refused: Callable[..., BuildError], diagnosed: Any, line: int, message: str
) -> None:
    written(tmp_path, M="model M\nend M;\n")
    found = refused("M", tmp_path / "M.mo", "M could not be compiled", {"M.mo": diagnosed})
    assert (found.file, found.line, found.message) == ("M.mo", line, message)


def test_a_warning_alone_leaves_it_to_the_text_of_the_compiler(
    tmp_path: Path, refused: Callable[..., BuildError]
) -> None:
    written(tmp_path, M="model M\n  Real y = 2*tme;\nend M;\n")
    diagnosed = {"M.mo": [("warning", at("M.mo", 3, "odd"))]}
    found = refused("M", tmp_path / "M.mo", "unresolved reference: 'tme'\nmore", diagnosed)
    assert (found.file, found.line) == ("M.mo", 2)
    assert found.message == "unresolved reference: 'tme'"


def test_files_of_a_library_are_named_from_the_folder_around_it(
    tmp_path: Path, refused: Callable[..., BuildError]
) -> None:
    library = written(tmp_path / "Lib", package="package Lib end Lib;")
    written(library / "Parts", A="model A end A;", B="model B end B;")
    diagnosed = {"A.mo": [("warning", at("A.mo", 1))], "B.mo": [("error", at("B.mo", 9, "odd"))]}
    found = refused("Lib.Parts.A", library, "no", diagnosed)
    assert (found.file, found.line, found.message) == ("Lib/Parts/B.mo", 9, "odd")


def test_a_place_in_the_text_of_the_compiler_counts_and_goes_out_of_the_words(
    tmp_path: Path, refused: Callable[..., BuildError]
) -> None:
    library = written(tmp_path / "Lib", package="package Lib end Lib;")
    written(library, A="model A end A;")
    text = f"too many equations [{library / 'A.mo'}:12:3]\nand more"
    found = refused("Lib.A", library, text, {})
    assert (found.file, found.line, found.message) == ("Lib/A.mo", 12, "too many equations")


USER = "model Ramp\n  Slope slope;\n  output Real y = slope.k;\nend Ramp;\n"
SLOPE = "model Slope\n  Real k;\nequation\n  k = 2*{};\nend Slope;\n"


def test_a_name_is_looked_for_in_the_models_beside_one_too(
    tmp_path: Path, refused: Callable[..., BuildError]
) -> None:
    """In those that it reaches; the model itself comes first."""
    written(
        tmp_path, Ramp=USER, Slope=SLOPE.format("tme"), Another="model Another tme end Another;"
    )
    text = "Ramp could not be compiled: unresolved component reference: 'tme'"
    found = refused("Ramp", tmp_path / "Ramp.mo", text, {})
    assert (found.file, found.line, found.message) == ("Slope.mo", 4, text)
    written(tmp_path, Ramp=USER.replace("slope.k", "slope.k + tme"))
    assert refused("Ramp", tmp_path / "Ramp.mo", text, {}).file == "Ramp.mo"
    written(tmp_path, Ramp=USER, Slope=SLOPE.format("time"))
    found = refused("Ramp", tmp_path / "Ramp.mo", text, {})
    assert (found.file, found.line) == ("Ramp.mo", 1)


def test_a_model_beside_one_that_is_no_modelica_is_blamed_where_the_compiler_names_it(
    tmp_path: Path, refused: Callable[..., BuildError]
) -> None:
    """What is wrong in a file that nobody uses is no reason."""
    written(tmp_path, Ramp=USER, Slope=SLOPE, Another="model Another")
    diagnosed = {name: [("error", at(name, 2))] for name in ("Slope.mo", "Another.mo")}
    text = f"no\n- {(tmp_path / 'Slope.mo').resolve()} [Resolve]: unexpected `k`"
    found = refused("Ramp", tmp_path / "Ramp.mo", text, diagnosed)
    assert (found.file, found.line, found.message) == ("Slope.mo", 2, "unexpected `k`")
    assert refused("Ramp", tmp_path / "Ramp.mo", "no", diagnosed).file == "Ramp.mo"


def test_a_file_beside_a_model_may_be_of_any_text(
    tmp_path: Path, refused: Callable[..., BuildError]
) -> None:
    written(tmp_path, Ramp=USER, Slope=SLOPE.format("tme"))
    (tmp_path / "Old.mo").write_bytes(b"// Achsger\xe4t")
    found = refused("Ramp", tmp_path / "Ramp.mo", "unresolved: 'tme'", {})
    assert (found.file, found.line) == ("Slope.mo", 4)


@pytest.mark.parametrize(
    ("slope", "line", "words"),
    [(SLOPE.format("tme"), 4, "tme"), ("model Slope\n  Real k\nequation\n  k = 1;\nend Slope;\n", 2,
                                       "unexpected `k`")],
)  # fmt: skip
def test_the_real_compiler_has_its_mistakes_blamed_so(
    tmp_path: Path, slope: str, line: int, words: str
) -> None:
    written(tmp_path, Ramp=USER, Slope=slope)
    with pytest.raises(BuildError, match=words) as caught:
        ir.compile_model("Ramp", tmp_path / "Ramp.mo", (LIBRARY,))
    assert (caught.value.file, caught.value.line) == ("Slope.mo", line)


@pytest.mark.parametrize(
    ("name", "hint"),
    [
        ("AxisRig.Drives.ServoAxis", "; write `import AxisRig;` into the model"),
        ("AxisRig.Drives.ServoAxes", "; did you mean AxisRig.Drives.ServoAxis"),
        ("Quite.Else", ""),
    ],
)
def test_a_class_that_does_not_exist_has_a_hint(
    tmp_path: Path, refused: Callable[..., BuildError], name: str, hint: str
) -> None:
    written(tmp_path, M=f"model M\n\n  extends {name};\nend M;\n")
    text = f"base class not found: `{name}` does not exist"
    found = refused("M", tmp_path / "M.mo", text, {}, LIBRARY)
    assert (found.file, found.line) == ("M.mo", 3)
    if hint:
        assert found.message.startswith(text + hint)
    else:
        assert found.message == text

    second = refused("M", tmp_path / "M.mo", f"{text} in `M.Part`", {}, LIBRARY).message
    assert second.startswith(f"{text} in `M.Part`{hint}")  # the first name is what is missing


@pytest.mark.parametrize(
    ("kind", "module", "is_refused"),
    [("PanicException", "pyo3_runtime", True), ("Other", "elsewhere", False)],
)
def test_a_panic_of_the_compiler_is_a_refusal_and_nothing_else_is(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, kind: str, module: str, is_refused: bool
) -> None:
    """It comes outside Exception, as what ends a process does."""
    panic = type(kind, (BaseException,), {"__module__": module})

    def session(_roots: list[str]) -> Any:
        raise panic("index out of bounds")

    written(tmp_path, M="model M\nend M;\n")
    monkeypatch.setattr(ir, "_compiled_in", set())
    monkeypatch.setattr(ir.rumoca, "Session", session)
    monkeypatch.setattr(ir.rumoca, "validate", lambda _: [])
    with pytest.raises(BuildError if is_refused else panic, match="index out of bounds"):
        ir.compile_model("M", tmp_path / "M.mo", ())


# In a process of its own


def asked_of(monkeypatch: pytest.MonkeyPatch, answer: object, *roots: Path) -> Any:
    """What a process that compiles is asked for, in a child of one that has compiled."""
    asked: list[bytes] = []

    def run(_command: list[str], *, input: bytes, **_: Any) -> Any:  # noqa: A002 - as subprocess
        asked.append(input)
        return SimpleNamespace(returncode=0, stdout=pickle.dumps(answer))

    monkeypatch.setattr(ir, "_compiled_in", {os.getpid() + 1})
    monkeypatch.setattr(subprocess, "run", run)
    if isinstance(answer, BuildError):
        with pytest.raises(BuildError) as caught:
            ir.compile_model("M", Path("mo/M.mo"), roots)
        assert (caught.value.file, caught.value.line) == (answer.file, answer.line)
    else:
        assert ir.compile_model("M", Path("mo/M.mo"), roots) == answer
    return asked[0]


@pytest.mark.parametrize("roots", [(), (Path("AxisRig"),), (Path("AxisRig"), Path("Other"))])
def test_a_process_of_its_own_compiles_with_the_same_libraries(
    roots: tuple[Path, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    """And writes what came of it, whether it is a model or a mistake with its place."""
    whole = ir.Ir("M", {"a": 1}, {}, {}, {}, Path("/mo"))
    for answer in (whole, BuildError("N.mo", 3, "odd")):
        asked = asked_of(monkeypatch, answer, *roots)
        compiled: list[Any] = []

        def compile_model(*task: Any, answer: Any = answer, compiled: Any = compiled) -> Any:
            compiled.append(task)
            if isinstance(answer, BuildError):
                raise answer
            return answer

        out = io.BytesIO()
        monkeypatch.setattr(ir.sys, "stdin", SimpleNamespace(buffer=io.BytesIO(asked)))
        monkeypatch.setattr(ir.sys, "stdout", SimpleNamespace(buffer=out))
        with monkeypatch.context() as patched:
            patched.setattr(ir, "compile_model", compile_model)
            ir.compile_alone()
        assert compiled == [("M", Path("mo/M.mo"), roots)]
        back = pickle.loads(out.getvalue())
        assert str(back) == str(answer)
        assert isinstance(back, type(answer))
