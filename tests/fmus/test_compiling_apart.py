"""A process that was forked from one that has compiled has another one compile."""

import os
import subprocess
from pathlib import Path
from types import SimpleNamespace

import pytest

from axisrig.fmus.reading import ir
from axisrig.fmus.reading.errors import BuildError

MODEL = """
model Half
  parameter Real k = 0.5;
  input Real u;
  output Real y;
equation
  y = k * u;
end Half;
"""


@pytest.fixture
def forked(monkeypatch: pytest.MonkeyPatch) -> None:
    """As in a child of a process that has compiled."""
    monkeypatch.setattr(ir, "_compiled_in", {os.getpid() + 1})


@pytest.mark.long
@pytest.mark.usefixtures("forked")
def test_it_compiles_to_the_same(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = tmp_path / "Half.mo"
    file.write_text(MODEL, encoding="utf-8")
    apart = ir.compile_model("Half", file)
    monkeypatch.setattr(ir, "_compiled_in", set())
    assert ir.compile_model("Half", file) == apart
    assert {os.getpid()} == ir._compiled_in


@pytest.mark.long
@pytest.mark.usefixtures("forked")
def test_what_the_compiler_refuses_comes_back(tmp_path: Path) -> None:
    file = tmp_path / "Half.mo"
    file.write_text(MODEL.replace("* u;", "* missing;"), encoding="utf-8")
    with pytest.raises(BuildError, match="missing") as caught:
        ir.compile_model("Half", file)
    assert caught.value.file == "Half.mo"


@pytest.mark.usefixtures("forked")
def test_the_end_of_the_other_process_is_an_error(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    ended = SimpleNamespace(returncode=-9, stdout=b"")
    monkeypatch.setattr(subprocess, "run", lambda *_, **__: ended)
    with pytest.raises(BuildError, match="the compiler ended with -9"):
        ir.compile_model("Half", tmp_path / "Half.mo")
