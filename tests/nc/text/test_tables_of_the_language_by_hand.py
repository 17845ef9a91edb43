"""Stored tables of a grammar, words that share an example, and hints that belong elsewhere."""

import hashlib
import sys
from pathlib import Path

import lark
import pytest

from axisrig.kernel.errors import UserError
from axisrig.kernel.nc.text.parser import parse_program
from axisrig.kernel.nc.text.stored_grammar import stored_grammar
from axisrig.kernel.nc.text.words import examples, find_variable, rows, variables

XYZ = ("X", "Y", "Z")
GRAMMAR = 'start: A+\nA: "a" | "b"\n'
OPTIONS = {"parser": "lalr"}


class Counting(lark.Transformer):  # type: ignore[type-arg]
    """Gives how many letters there are."""

    def start(self, letters: list[str]) -> int:
        return len(letters)


def tables(folder: Path, text: str = GRAMMAR) -> tuple[int, list[str]]:
    """Read three letters by the grammar of a folder; the files that are there then."""
    grammar = stored_grammar(text, OPTIONS, Counting(), folder)
    return grammar.parse("aba"), sorted(path.name for path in folder.iterdir())  # type: ignore[return-value]


@pytest.mark.parametrize("damage", ["flipped", "cut", "longer", "empty", "other tables"])
def test_a_file_that_is_not_what_it_was_is_written_again(tmp_path: Path, damage: str) -> None:
    found, (name,) = tables(tmp_path)
    assert found == 3
    file = tmp_path / name
    content = file.read_bytes()
    damaged = {
        "flipped": content[:-1] + bytes([content[-1] ^ 1]), "cut": content[:-1],
        "longer": content + b"\0", "empty": b"", "other tables": content[:32] + b"tables",
    }  # fmt: skip
    file.write_bytes(damaged[damage])
    assert tables(tmp_path) == (3, [name])
    again = file.read_bytes()
    assert again not in damaged.values()
    assert again[:32] == hashlib.sha256(again[32:]).digest()


def test_a_grammar_another_python_and_another_option_have_files_of_their_own(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    _, first = tables(tmp_path)
    assert tables(tmp_path)[1] == first
    _, second = tables(tmp_path, GRAMMAR + "// of another version\n")
    monkeypatch.setattr(sys, "version", "3.99 (another one)")
    _, third = tables(tmp_path)
    stored_grammar(GRAMMAR, {**OPTIONS, "lexer": "basic"}, Counting(), tmp_path)
    assert [len(found) for found in (first, second, third)] == [1, 2, 3]
    assert len(list(tmp_path.iterdir())) == 4


def test_each_word_of_a_row_of_examples_has_its_example() -> None:
    found = examples()
    several = 0
    for row in rows("examples.csv"):
        names = row["words"].split("|")
        several += len(names) > 1
        for name in names:
            assert found[name] == (row["example"].replace("\\n", "\n"), row["page"])
    assert several > 1


def test_a_name_that_has_a_row_of_its_own_is_none_of_a_row_for_any_name() -> None:
    for row in variables():
        if "<name>" not in row.name:
            assert find_variable(row.name.replace("<axis>", "X"))[0] is row


@pytest.mark.parametrize(
    ("text", "hint"),
    [
        ("G1 X1, Y2 (the first corner)", None),
        ("G1 X1 ? (the first corner)", None),
        ("P1=(1+2)*3", "( ) hold comments; [ ] group an expression"),
        ("X=(5)", "( ) hold comments; [ ] group an expression"),
    ],
)
def test_a_comment_behind_an_error_is_no_group_of_an_expression(
    text: str, hint: str | None
) -> None:
    with pytest.raises(UserError) as caught:
        parse_program(text, file="p.nc", axes=XYZ)
    assert caught.value.hint == hint


@pytest.mark.parametrize("action", ["ON", "DRYRUN", "OFF", "FREEZE", "CHECK_POS", "REF"])
def test_wait_is_beside_every_action_of_the_channel_and_some_of_an_axis(action: str) -> None:
    """FCT-M3 12.2, and TF5200 programming manual 208654987 for an axis."""
    parse_program(f"#DIST CTRL [WAIT {action}]", file="p.nc", axes=XYZ)
    text = f"Z[DIST_CTRL WAIT {action}]"
    if action not in ("CHECK_POS", "REF"):
        parse_program(text, file="p.nc", axes=XYZ)
        return
    with pytest.raises(UserError, match=r"WAIT of Z\[DIST_CTRL needs ON or DRYRUN or OFF"):
        parse_program(text, file="p.nc", axes=XYZ)
