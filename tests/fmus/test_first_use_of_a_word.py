"""Which use of a word that is not supported is named: the first call in what the model reaches."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import pytest
from tests.fmus.test_what_is_not_supported import ir

from axisrig.fmus.reading.errors import BuildError
from axisrig.fmus.reading.support import refuse_unsupported

USED = {"delay": "temporal__delays", "terminal": "temporal__terminals",
        "previous": "temporal__previous"}  # fmt: skip


def place(word: str, *files: str) -> str:
    """Return where files of a library say that a word is."""
    known: Mapping[int, tuple[Path, str]] = {
        number + 1: (Path(f"/lib/F{number + 1}.mo"), text) for number, text in enumerate(files)
    }
    found = replace(ir(**{USED[word]: [1]}), files=dict(known))
    with pytest.raises(BuildError) as error:
        refuse_unsupported(found)
    name, line = error.value.file, error.value.line
    found_at = str(name) if line is None else f"{name}:{line}"
    assert str(error.value) == f"{found_at}: {word}() is not supported"
    return found_at


@pytest.mark.parametrize("word", USED)
@pytest.mark.parametrize("sign", ["a", "\u20ac"], ids=["1 byte", "3 bytes"])
def test_signs_of_several_bytes_before_a_use_leave_its_line(word: str, sign: str) -> None:
    text = f"model M\n  Real x = {word}(time, 1);\nend M;\n"
    assert place(word, f"// {sign * 40}\n{text}") == "F1.mo:3"


def test_the_first_use_counts_and_what_the_model_reaches_alone() -> None:
    twice = "model M\n  Real a;\n  Real x = delay(a, 1);\n  Real y = delay(a, 2);\nend M;\n"
    assert place("delay", twice) == "F1.mo:3"
    other = "model Other\n  Real x = delay(time, 1);\nend Other;\n"
    part = "model Part\n\n\n  Real x = delay(time, 1);\nend Part;\n"
    uses = "model M\n  Part part;\nend M;\n"
    assert place("delay", other, part, uses) == "F2.mo:4"
    assert place("delay", other, "model M\n  Real x;\nend M;\n") == "Lib.M"


def test_the_model_itself_comes_before_its_parts() -> None:
    part = "model Part\n  Real x = delay(time, 1);\nend Part;\n"
    own = "// \u00e4\u00e4\u00e4\nmodel M\n  Part part;\n  Real x = delay(time, 1);\nend M;\n"
    assert place("delay", part, own) == "F2.mo:4"


def test_an_inner_class_is_reached_by_its_name_alone() -> None:
    inner = (
        "package Lib\n// \u20ac\u20ac\nmodel Far\n  Real x = delay(time, 1);\nend Far;\n"
        "model M\n  {}\nend M;\nend Lib;\n"
    )
    assert place("delay", inner.format("Far far;")) == "F1.mo:4"
    assert place("delay", inner.format("Real far;")) == "Lib.M"
