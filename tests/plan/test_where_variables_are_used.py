"""Where a V.E. variable may be used: every program of a run, moments, lists, the PLC program."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.campaign import used_variables as module
from axisrig.bench.campaign.used_variables import Used, is_variable, used_variables
from axisrig.bench.plan.assignment import parse_assignment
from axisrig.kernel.nc.text.parser import read_program

MAIN = "%MAIN\nN10 V.E.MAIN = 1\nN20 L sub\nN99 M30\n"
FILES = {
    "main.nc": MAIN,
    "sub.nc": "N10 V.E.SUB = 1\nM29\n",
    "started.nc": "%S\nN10 V.E.STARTED = 1\nN20 M30\n",
    "other.nc": "%O\nN10 V.E.OTHER = 1\nN20 M30\n",
}


class Words:
    """A list of parameters with these texts."""

    def __init__(self, *texts: str) -> None:
        self._texts = texts

    def words(self) -> tuple[str, ...]:
        return self._texts


def found(
    place: Path, patch: pytest.MonkeyPatch, *started: str, main: str = MAIN, **parts: Any
) -> Used:
    for name, text in {**FILES, "main.nc": main}.items():
        (place / name).write_text(text, encoding="utf-8")
    programs = {name: read_program(place / name, ("Z",)) for name in ("main.nc", *started)}
    patch.setattr(module, "programs_of", lambda *_: programs)
    task = None if "task" not in parts else SimpleNamespace(program=parts["task"])
    settings: Any = SimpleNamespace(
        plc=parts.get("plc", []), channel=parts.get("channel", Words()),
        axis=parts.get("axis", {}), rig=SimpleNamespace(plc_task=task),
    )  # fmt: skip
    return used_variables(settings, place / "main.nc", programs["main.nc"])


def moment(word: str) -> Any:
    return SimpleNamespace(word=word)


def test_every_program_that_a_run_can_reach_counts(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """That of the row, what it calls, and what the PLC side starts; no other file of the folder."""
    assert found(tmp_path, monkeypatch).names == {"MAIN", "SUB"}
    both = found(tmp_path, monkeypatch, "started.nc")
    assert (both.names, both.all_may) == ({"MAIN", "SUB", "STARTED"}, False)


def test_names_count_in_any_letters_and_in_comments_too(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    text = "%MAIN\nN10 v.e.Feed = V.E.feed + V.e.STEP_2\nN20 ( V.E.NOTED )\nN99 M30\n"
    assert found(tmp_path, monkeypatch, main=text).names == {"FEED", "STEP_2", "NOTED"}


def test_moments_of_cells_use_variables_at_their_begin_and_at_their_end(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    rules = [
        SimpleNamespace(moment=moment("V.E.BEGIN"), until=moment("V.E.END")),
        SimpleNamespace(moment=moment("V.E.ALONE"), until=None),
        SimpleNamespace(moment=None, until=moment("V.E.LAST")),
        SimpleNamespace(moment=moment("start"), until=moment("motion")),  # words of moments.csv
    ]
    names = found(tmp_path, monkeypatch, plc=rules).names
    assert names == {"MAIN", "SUB", "BEGIN", "END", "ALONE", "LAST"}


def test_lists_of_the_channel_and_of_each_axis_use_variables(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    used = found(
        tmp_path, monkeypatch, channel=Words("V.E.CH", "no name", "V.E.A V.E.B"),
        axis={"X": Words("V.E.OF_X"), "Z": Words("", "x V.E.OF_Z y")},
    )  # fmt: skip
    assert used.names == {"MAIN", "SUB", "CH", "A", "B", "OF_X", "OF_Z"}


@pytest.mark.parametrize(
    ("text", "names", "all_may"),
    [
        ('def cycle(hli):\n    hli.ve["OF_PLC"] = 1\n', {"OF_PLC"}, False),
        ("def cycle(hli, name):\n    hli.ve[name] = 1\n", set(), True),
    ],
)
def test_a_program_of_the_plc_counts_where_the_rig_has_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, text: str, names: set[str], all_may: bool
) -> None:
    plc = tmp_path / "plc.py"
    plc.write_text(text, encoding="utf-8")
    used = found(tmp_path, monkeypatch, task=str(plc))
    assert (used.names, used.all_may) == ({"MAIN", "SUB", *names}, all_may)
    assert used.has("plc:V.E.NOWHERE") is all_may
    without = found(tmp_path, monkeypatch, task=None)
    assert without.names == {"MAIN", "SUB"}


@pytest.mark.parametrize(
    ("names", "column", "has", "hint"),
    [
        ({"FEED", "ACC"}, "plc:V.E.FED", "V.E.ACC, V.E.FEED", "did you mean V.E.FEED?"),
        ({"FEED"}, "plc:V.E.ZZZZZZ", "V.E.FEED", None),
        (set(), "plc:V.E.FEED", "no variable of the PLC", None),
    ],
)
def test_a_column_that_nothing_uses_names_what_is_used(
    names: set[str], column: str, has: str, hint: str | None
) -> None:
    used = Used(frozenset(names), all_may=False)
    error = used.error(parse_assignment(f"{column}=7"), Path("nc/part.nc"))
    words = f"{column} is not used: part.nc and the PLC program of the rig have {has}"
    assert (error.message, error.value, error.hint) == (words, "7", hint)


@pytest.mark.parametrize(
    ("text", "is_one"),
    [("plc:V.E.FEED=1", True), ("plc:feedhold=1", False), ("set:Z.a=1", False),
     ("plant:z.x_mm=1", False)],
)  # fmt: skip
def test_only_inputs_of_the_plc_with_their_head_are_variables(text: str, is_one: bool) -> None:
    assert is_variable(parse_assignment(text)) is is_one
