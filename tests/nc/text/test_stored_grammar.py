"""The tables of the grammar from the cache: the same parser, whatever happened to the file."""

import os
from importlib import resources
from pathlib import Path
from typing import Any

import lark
import platformdirs
import pytest

from axisrig.kernel.nc.text import parser
from axisrig.kernel.nc.text.builder import Builder
from axisrig.kernel.nc.text.stored_grammar import stored_grammar

PROGRAMS = sorted((Path(__file__).parents[3] / "testplans" / "programs").rglob("*.nc"))
AXES = ("X", "Y", "Z", "A", "B", "C", "U", "V", "W", "X2", "S")
TEXT = resources.files("axisrig.kernel.nc.text").joinpath("grammar.lark").read_text("utf-8")


def outcomes(monkeypatch: pytest.MonkeyPatch, grammar: lark.Lark, builder: Builder) -> list[Any]:
    """What each shipped program, and each with its letters moved, is read as."""
    monkeypatch.setattr(parser, "_grammar_and_builder", lambda: (grammar, builder))
    found: list[Any] = []
    for file in PROGRAMS:
        text = parser.read_text(file)
        for one in (text, text.replace("G", "G G"), text.replace("[", "[[")):
            reading = parser.Reading(one, file, AXES)
            reading.run()
            found.append((reading.program(), [str(error) for error in reading.errors]))
    return found


@pytest.mark.long
def test_a_parser_from_the_file_reads_every_shipped_program_as_one_from_the_text(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    fresh, stored = Builder(), Builder()
    grammar = lark.Lark(TEXT, **parser.OPTIONS, transformer=fresh)
    stored_grammar(TEXT, parser.OPTIONS, Builder(), tmp_path)  # writes the file
    (file,) = tmp_path.iterdir()
    monkeypatch.setattr(lark, "Lark", _Closed)  # nothing is made from the text any more
    loaded = stored_grammar(TEXT, parser.OPTIONS, stored, tmp_path)
    expected = outcomes(monkeypatch, grammar, fresh)
    assert len(expected) > 100
    assert sum(bool(errors) for _, errors in expected) > 50
    assert outcomes(monkeypatch, loaded, stored) == expected
    assert [path.name for path in tmp_path.iterdir()] == [file.name]


class _Closed(lark.Lark):
    def __init__(self, *_: object, **__: object) -> None:
        raise AssertionError("the tables were made again")


@pytest.mark.long
@pytest.mark.parametrize("damage", ["empty", "cut", "flipped", "foreign"])
def test_a_damaged_file_is_written_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, damage: str
) -> None:
    stored_grammar(TEXT, parser.OPTIONS, Builder(), tmp_path)
    (file,) = tmp_path.iterdir()
    content = file.read_bytes()
    file.write_bytes(
        {
            "empty": b"",
            "cut": content[:-1],
            "flipped": content[:5000] + bytes([content[5000] ^ 1]) + content[5001:],
            "foreign": b"no tables at all" * 10,
        }[damage]
    )
    assert stored_grammar(TEXT, parser.OPTIONS, Builder(), tmp_path).parse("N10", start="block")
    monkeypatch.setattr(lark, "Lark", _Closed)
    assert stored_grammar(TEXT, parser.OPTIONS, Builder(), tmp_path).parse("N10", start="block")


@pytest.mark.long
def test_without_a_folder_to_write_to_the_tables_are_made_each_time(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    for _ in range(2):
        grammar = stored_grammar(TEXT, parser.OPTIONS, Builder(), tmp_path / "file" / "grammar")
        assert grammar.parse("N10", start="block")
    assert [path.name for path in tmp_path.iterdir()] == ["file"]


@pytest.mark.long
def test_another_text_has_a_file_of_its_own(tmp_path: Path) -> None:
    stored_grammar(TEXT, parser.OPTIONS, Builder(), tmp_path)
    stored_grammar(f"{TEXT}\n// one more line\n", parser.OPTIONS, Builder(), tmp_path)
    assert len(list(tmp_path.iterdir())) == 2


def test_other_options_have_a_file_of_their_own(tmp_path: Path) -> None:
    """Values count, not only names: places of another kind would come from the tables."""
    for value in (False, True):
        options = {"parser": "lalr", "propagate_positions": value}
        stored_grammar('start: "a"', options, lark.Transformer(), tmp_path)
    assert len(list(tmp_path.iterdir())) == 2


SMALL = {"parser": "lalr"}


def small(folder: Path) -> lark.Lark:
    """A parser that is made in a moment."""
    return stored_grammar('start: "a"', SMALL, lark.Transformer(), folder)


def test_a_file_that_cannot_be_put_in_place_leaves_nothing_behind(tmp_path: Path) -> None:
    small(tmp_path)
    (file,) = tmp_path.iterdir()
    file.unlink()
    file.mkdir()  # nothing can take its name
    assert small(tmp_path).parse("a").data == "start"
    assert list(tmp_path.iterdir()) == [file]


def test_tables_of_somebody_else_are_not_read(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """They are what the parser does: only a file of one's own is loaded."""
    small(tmp_path)
    (file,) = tmp_path.iterdir()
    own = file.stat().st_uid
    monkeypatch.setattr(lark, "Lark", _Closed)
    assert small(tmp_path).parse("a").data == "start"
    monkeypatch.setattr(os, "getuid", lambda: own + 1)
    with pytest.raises(AssertionError, match="made again"):
        small(tmp_path)


def test_without_a_folder_the_tables_are_in_the_cache_of_the_user(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(platformdirs, "user_cache_dir", lambda name: str(tmp_path / name))
    stored_grammar('start: "a"', SMALL, lark.Transformer())
    (file,) = (tmp_path / "axisrig" / "grammar").iterdir()
    assert file.suffix == ".tables"
