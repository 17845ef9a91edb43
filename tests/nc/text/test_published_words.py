"""Words that the maker of the kernel publishes and nobody carries out here (`published.csv`)."""

import csv
from pathlib import Path
from typing import Any

import pytest

from axisrig.kernel.errors import Alarm, UserError
from axisrig.kernel.nc.canon import LinearMove
from axisrig.kernel.nc.decoder import Interpreter
from axisrig.kernel.nc.text.check import check_program
from axisrig.kernel.nc.text.parser import parse_program
from axisrig.kernel.nc.text.published import published, published_command
from axisrig.kernel.nc.text.words import commands, words

XYZ = ("X", "Y", "Z")
MOVES_THE_CONTACT = (
    *("G20", "G21", "G22", "G23", "G351"),  # mirror
    *("G51", "G52"),  # diameter
    *("#MCS ON", "#MCS OFF", "#TRC", "#HSC ON", "#HSC OFF", "#OVERRIDE"),
)
WRITTEN = {
    "G128": "G128 = 70",
    "G112": "G112 X4 Y8",
    "G303": "G303 I1 J2 K3 X4 Y5 Z6",
    "G115": "G115=3",
}
"""As the manual prints them; each other one stands alone."""
VALUES = {
    "#HSC ON": "#HSC ON [BSPLINE PATH_DEV 0.01 AUTO_OFF_G00=1]",
    "#FILE NAME": '#FILE NAME [MP="part # 1.nc"]',
    "#CYL": "#CYL [R=20, RADIAL] [2,,3]",
    "#CONTROL AREA BEGIN": "#CONTROL AREA BEGIN [ID3 WORK POLY MIN_EXCUR=-20 MAX_EXCUR=60]",
    "#TIMER": "#TIMER START [ID1 -> ]",
}


def blocks(row: Any) -> str:
    return WRITTEN.get(row.word, VALUES.get(row.word, row.word))


def test_the_table_has_no_word_of_another_one_and_says_what_each_is_for() -> None:
    assert len(published()) > 280
    for word, row in published().items():
        assert row.meaning
        assert row.source
        assert word not in words("G")
        assert word.removeprefix("#") not in commands()


def test_every_published_word_is_read_noted_with_its_place_and_does_not_act() -> None:
    """All in one program, after a motion and before its end, with the values that some have."""
    rows = list(published().values())
    text = "\n".join(
        ["N1 G0 X1", *(f"/N{at}0 {blocks(row)}" for at, row in enumerate(rows, 1)), "M30"]
    )
    checked = check_program(text, "own.nc", XYZ)
    assert [str(error) for error in checked.errors] == []
    found = {(note.line, note.text.partition(" is in the manuals")[0]) for note in checked.notes}
    assert {(at, row.word) for at, row in enumerate(rows, 2)} <= found
    parts = checked.program.blocks
    assert [part.skip for part in parts[1:-1]] == [1] * len(rows)
    assert [part.block.number for part in parts[1:3]] == [10, 20]


@pytest.mark.parametrize(
    "block", ["#HSC ON [BSPLINE]", "G128 = 70", "G81 Z-10 Q5", "G1 G51 X5", "N5: #TRC"]
)
@pytest.mark.provokes(900100, 2)
def test_a_program_ends_at_such_a_block_only_if_it_gets_there(run: Any, block: str) -> None:
    assert len(_moves(run(f"G0 X1\n$IF 0\n{block}\n$ENDIF\nX2"))) == 2
    with pytest.raises(Alarm) as caught:
        run(f"G0 X1\n{block}\nX2")
    assert caught.value.id == 900100
    assert str(caught.value.values["word"]) in block


@pytest.mark.parametrize(
    ("text", "near"),
    [
        ("#HCS ON", "#HSC ON"),
        ("#CACHE LAOD", "#CACHE LOAD"),
        ("G3033", "G303"),
        ("#TIMERS", "#TIMER"),
    ],
)
def test_a_word_of_no_table_stays_an_error_with_near_names(text: str, near: str) -> None:
    (error,) = check_program(text, "own.nc", XYZ).errors
    assert "unknown" in error.message
    assert near in f"{error.allowed} {error.hint}"


def test_a_mistake_before_such_a_word_is_still_one() -> None:
    with pytest.raises(UserError, match="axis X has no value"):
        parse_program("N10 G1 X+ #TIMER", axes=XYZ)
    with pytest.raises(UserError, match="unknown G function"):
        parse_program("N10 G777 G51", axes=XYZ)


def test_what_moves_the_contact_is_never_passed_over() -> None:
    for word in MOVES_THE_CONTACT:
        assert not published()[word].passed_over, word
    assert {"G40", "G41", "G42"}.isdisjoint(published())


@pytest.mark.parametrize("block", ["#TIMER [ID=1 START]", "G25", "G1 G25 X5 F100", "#CACHE LOAD"])
def test_a_word_is_passed_over_and_the_rest_of_its_block_acts(
    plane_machine: Any, block: str
) -> None:
    """On, off, on: with the word, without it, and where another one is passed over."""

    def moves(passed: list[str]) -> list[Any]:
        program = parse_program(f"G0 X1\n{block}\nX2 Y3", file="own.nc", axes=XYZ)
        machine = plane_machine(dict.fromkeys(XYZ, 0.0), None)
        interpreter = Interpreter(program, XYZ, machine, external={})
        interpreter.pass_over(passed)
        return _moves(list(interpreter.commands()))

    word = next(word for word in ("#TIMER", "G25", "#CACHE LOAD") if word in block)
    assert len(moves([word])) == (3 if "X5" in block else 2)
    for others in ([], ["#SINGLE STEP"]):
        with pytest.raises(Alarm, match="900100"):
            moves(others)
    assert len(moves(["#SINGLE STEP", word])) == (3 if "X5" in block else 2)


@pytest.mark.parametrize("block", ["G25 G51 X5", "G51 G25 X5", "G1 G25 G51"])
@pytest.mark.provokes(900100, 2, word="G51")
def test_of_two_words_in_a_block_the_one_that_is_not_passed_over_ends_the_program(
    plane_machine: Any, block: str
) -> None:
    program = parse_program(f"G0 X1\n{block}\nX2", file="own.nc", axes=XYZ)
    machine = plane_machine(dict.fromkeys(XYZ, 0.0), None)
    interpreter = Interpreter(program, XYZ, machine, external={})
    interpreter.pass_over(["G25"])
    with pytest.raises(Alarm, match="900100"):
        list(interpreter.commands())


def test_notes_say_what_could_be_and_what_is_passed_over() -> None:
    (could,) = check_program("#TIMER", "own.nc", XYZ).notes
    assert '[language] pass_over = ["#TIMER"]' in could.text
    (passed,) = check_program("#TIMER", "own.nc", XYZ, ("#TIMER",)).notes
    assert "#TIMER is passed over" in passed.text
    (never,) = check_program("#TRC", "own.nc", XYZ).notes
    assert "pass_over" not in never.text


def test_of_several_words_only_the_named_ones_are_passed_over() -> None:
    """Each note is of its own word, whatever a rig passes over beside it."""
    text = "#TIMER\n#CACHE LOAD\n#TRC\nG25"
    for passed in (["#TIMER"], ["G25", "#CACHE LOAD"], ["#SINGLE STEP"]):
        notes = check_program(text, "own.nc", XYZ, passed).notes
        assert [note.line for note in notes] == [1, 2, 3, 4]
        for note, word in zip(notes, text.split("\n"), strict=True):
            is_passed = word in passed
            assert note.text.startswith(f"{word} is passed over") is is_passed
            assert ("does not act yet" in note.text) is not is_passed
            assert (f'["{word}"] of a rig' in note.text) is (not is_passed and word != "#TRC")


def test_the_table_is_sorted_so_that_a_word_is_found() -> None:
    text = Path("kernel/axisrig/kernel/nc/text/published.csv").read_text(encoding="utf-8")
    rows = list(csv.DictReader(text.splitlines()))
    assert rows == sorted(
        rows,
        key=lambda row: (
            row["kind"] == "#",
            int(row["word"][1:]) if row["kind"] == "G" else row["word"],
        ),
    )


def _moves(found: list[Any]) -> list[LinearMove]:
    return [command for command in found if isinstance(command, LinearMove)]


def test_of_names_that_begin_alike_the_longest_one_counts() -> None:
    """`#CS ADD DEL` is published where `#CS ADD` acts; of `#COMMAND WAIT SYN` the long one acts."""
    for word in published():
        if word[0] == "#":
            code = f"N10 {word} [1]"
            found = published_command(code, 0, len(code))
            assert found is not None
            assert (found[0].word, found[1]) == (word, 4)
    for name in commands():
        code = f"#{name.lower()} [1]"
        assert published_command(code, 0, len(code)) is None, name
    assert published_command("#CS  ADD\tDEL [1]", 0, 17) == (published()["#CS ADD DEL"], 0)
    assert published_command("G0 X1 #CYL", 0, 5) is None
