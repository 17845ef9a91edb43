"""Where an equation is in the files of a library, and what an enumeration of it is called."""

from pathlib import Path
from typing import Any

import pytest

from axisrig.fmus.reading.ir import Ir

ROOT = Path("/models")
TEXT = "// \u00e4\n\n\nmodel M\n\n  Real x;\nend M;\n"


def ir(flat: Any = None) -> Ir:
    files = {1: (ROOT / "Lib" / "M.mo", TEXT), 4: (Path("/elsewhere/N.mo"), "a\nb\nc")}
    return Ir("Lib.M", {}, {}, flat or {}, files, ROOT)


@pytest.mark.parametrize(
    ("source", "start", "place"),
    [
        (1, 0, "Lib/M.mo:1"), (1, 5, "Lib/M.mo:1"), (1, 6, "Lib/M.mo:2"), (1, 7, "Lib/M.mo:3"),
        (1, TEXT.encode().index(b"model"), "Lib/M.mo:4"),
        (1, TEXT.encode().index(b"Real"), "Lib/M.mo:6"),
        (1, TEXT.encode().index(b"end"), "Lib/M.mo:7"),
        (4, 0, "/elsewhere/N.mo:1"), (4, 4, "/elsewhere/N.mo:3"),
    ],
)  # fmt: skip
def test_a_place_is_a_line_of_a_file_counted_in_bytes(source: int, start: int, place: str) -> None:
    span = {"source": source, "start": start}
    assert str(ir().place(span)) == place
    error = ir().error(span, "wrong")
    assert str(error) == f"{place}: wrong"
    assert f"{error.file}:{error.line}" == place


@pytest.mark.parametrize("span", [None, {"source": 2, "start": 0}, {"start": 0}])
def test_what_has_no_place_is_of_the_model(span: Any) -> None:
    assert ir().place(span) is None
    assert str(ir().error(span, "wrong")) == "Lib.M: wrong"


@pytest.mark.parametrize(
    ("literals", "kind", "found"),
    [
        ({"Lib.Way.b": 2, "Lib.Way.a": 1}, "Way", ("Lib.Way", ("a", "b"))),
        ({"Lib.Way.b": 2, "Lib.Way.'a c'": 1}, "Lib.Way", ("Lib.Way", ("a c", "b"))),
        # one type under two names; two types of one name
        ({"Way.a": 1, "Lib.Way.a": 1, "Other.b": 1}, "Way", ("Lib.Way", ("a",))),
        ({"One.Way.a": 1, "Two.Way.b": 1}, "Way", None),
        ({"One.Way.a": 1, "Two.Way.b": 1}, "Two.Way", ("Two.Way", ("b",))),
        ({"Lib.NoWay.a": 1}, "Way", None), ({}, "Way", None),
    ],
)  # fmt: skip
def test_an_enumeration_is_that_of_its_literals(
    literals: dict[str, int], kind: str, found: Any
) -> None:
    flat = {"variable_type_names": {"x": kind}, "enum_literal_ordinals": literals}
    assert ir(flat).enumeration_of("x") == found
    assert ir(flat).enumeration_of("y") is None
