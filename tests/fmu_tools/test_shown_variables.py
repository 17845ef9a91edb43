"""Variables, libraries and refusals of `axisrig fmu show`, of descriptions made by hand."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import fmpy
import pytest
from rich.console import Console
from tests.fmu_tools.described import variable

from axisrig.bench.tools.fmu import show
from axisrig.bench.tools.fmu.show import Shown
from axisrig.kernel.errors import UserError

COLUMNS = ("variable", "causality", "type", "unit", "start",
           "variability", "min", "max", "description")  # fmt: skip


def own(name: str, **given: Any) -> Any:
    return variable(name, **{"unit": None, "declaredType": None, "description": None, **given})


def cells(*variables: Any, columns: tuple[str, ...] = COLUMNS) -> list[dict[str, str]]:
    """The rows of the table by the heads of its columns."""
    table = show._variables(variables, columns)
    assert [str(column.header) for column in table.columns] == list(columns)
    rows = zip(*(column.cells for column in table.columns), strict=True)
    return [dict(zip(columns, map(str, row), strict=True)) for row in rows]


@pytest.mark.parametrize(
    ("shape", "text"),
    [((), "Float64"), (None, "Float64"), ((3,), "Float64[3]"), ((2, 3), "Float64[2][3]")],
)
def test_an_array_is_shown_with_its_extents(shape: Any, text: str) -> None:
    (row,) = cells(own("v", shape=shape))
    assert row["type"] == text


def test_each_column_is_what_its_head_says_and_nothing_where_there_is_nothing() -> None:
    full = own("x", causality="output", type="Real", unit="mm", start="0.5", min="-1", max="2",
               description="a way", variability="discrete")  # fmt: skip
    typed = own("y", declaredType=SimpleNamespace(unit="um"), start="0")
    assert cells(full, typed) == [
        {"variable": "x", "causality": "output", "type": "Real", "unit": "mm", "start": "0.5",
         "variability": "discrete", "min": "-1", "max": "2", "description": "a way"},
        {"variable": "y", "causality": "input", "type": "Float64", "unit": "um", "start": "0",
         "variability": "continuous", "min": "", "max": "", "description": ""},
    ]  # fmt: skip
    assert cells(full, columns=("start", "variable")) == [{"start": "0.5", "variable": "x"}]


def shown(*variables: Any) -> Shown:
    words = ("description", "version", "author", "license", "generationTool",
             "generationDateAndTime", "coSimulation", "modelExchange", "scheduledExecution",
             "defaultExperiment")  # fmt: skip
    description: Any = SimpleNamespace(
        **dict.fromkeys(words), modelName="M", fmiVersion="3.0", modelVariables=variables,
        buildConfigurations=[], outputs=[], derivatives=[], eventIndicators=[],
        numberOfEventIndicators=0, initialUnknowns=[],
    )  # fmt: skip
    archive: Any = SimpleNamespace(path=Path("a.fmu"), entries=[], sha256="ab", size=1)
    return Shown(archive, description, None, [])


KINDS = ("structuralParameter", "parameter", "calculatedParameter", "input", "output", "local",
         "independent")  # fmt: skip


@pytest.mark.parametrize("is_all", [False, True])
def test_local_variables_and_the_time_are_shown_where_all_are_wanted(
    is_all: bool, capsys: pytest.CaptureFixture[str]
) -> None:
    show.show_fmu(shown(*(own(f"its_{kind}", causality=kind) for kind in KINDS)), is_all=is_all)
    text = capsys.readouterr().out
    assert [kind for kind in KINDS if f"its_{kind} " in text] == list(
        KINDS if is_all else KINDS[:5]
    )
    hidden = "2 variables, local ones and time, are not shown; --all shows them"
    assert (hidden in text) is not is_all


@pytest.fixture
def described(monkeypatch: pytest.MonkeyPatch) -> Any:
    """A description in place of the one that is read, or an error; the libraries by identifier."""

    def put(found: Any) -> None:
        def read(_folder: str, *, validate: bool) -> Any:
            assert not validate
            if isinstance(found, Exception):
                raise found
            return found

        monkeypatch.setattr(fmpy, "read_model_description", read)

    monkeypatch.setattr(show, "unpack", lambda path: path / "unpacked")
    monkeypatch.setattr(show, "inspect", lambda path: path)
    monkeypatch.setattr(show, "find_binaries", lambda folder, name: [f"{folder.name}:{name}"])
    return put


@pytest.mark.parametrize(
    ("error", "text"),
    [(ValueError("no such word\nin line 3"), "no such word"), (ValueError("bad"), "bad"),
     (KeyError(), "KeyError"), (ValueError("\nline 2"), "ValueError")],
)  # fmt: skip
def test_a_description_that_is_none_is_refused_by_the_first_line(
    described: Any, error: Exception, text: str
) -> None:
    described(error)
    with pytest.raises(UserError) as caught:
        show.read_fmu(Path("a.fmu"))
    assert caught.value.message == f"the model description is rejected: {text}"
    assert caught.value.hint == "axisrig fmu check FILE lists what is wrong"


@pytest.mark.parametrize(
    ("exchange", "scheduled", "libraries"),
    [("b", "a", ["a", "b"]), ("a", "a", ["a"]), ("b", None, ["b"]), (None, None, [])],
)
def test_libraries_of_all_interfaces_are_found_each_once(
    described: Any, exchange: str | None, scheduled: str | None, libraries: list[str]
) -> None:
    def interface(name: str | None) -> Any:
        return None if name is None else SimpleNamespace(modelIdentifier=name)

    described(SimpleNamespace(coSimulation=None, modelExchange=interface(exchange),
                              scheduledExecution=interface(scheduled)))  # fmt: skip
    found = show.read_fmu(Path("a.fmu"))
    assert found.binaries == [f"unpacked:{name}" for name in libraries]
    assert found.can is None


@pytest.mark.parametrize(
    ("width", "has_all"), [(80, False), (119, False), (120, True), (200, True)]
)
def test_a_window_of_120_signs_holds_all_columns(
    width: int, has_all: bool, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """In a narrower one a line says what is not shown."""

    def window(**words: Any) -> Console:
        return Console(width=width, force_terminal=True, color_system=None, **words)

    monkeypatch.setattr(show, "Console", window)
    show.show_fmu(shown(own("x", causality="output", description="a way")), is_all=False)
    text = capsys.readouterr().out
    head = next(line for line in text.splitlines() if line.split()[:2] == ["variable", "causality"])
    assert head.split() == list(COLUMNS if has_all else COLUMNS[:5])
    assert ("a way" in text) is has_all
    words = "a window of 120 columns, or a file, shows variability, min, max, description"
    assert (words in text) is not has_all


def test_a_file_has_all_columns_and_no_name_in_two_lines(
    capsys: pytest.CaptureFixture[str],
) -> None:
    """What is written into a file or a pipe is searched: names of 150 signs stay whole."""
    name = "part." * 30
    show.show_fmu(shown(own(name, causality="output", description="a way")), is_all=False)
    (line,) = [one for one in capsys.readouterr().out.splitlines() if name in one]
    assert line.split() == [name, "output", "Float64", "continuous", "a", "way"]


def test_signs_that_steer_a_terminal_do_nothing_in_the_table() -> None:
    """ESC of a colour, a bell and a line feed of a description come from its maker."""
    (row,) = cells(own("x\x1b[31m", description="a\nway\a", start="\x1b[2J"))
    assert not any(sign in text for text in row.values() for sign in "\x1b\a\n")
    assert row["variable"].startswith("x")


@pytest.mark.parametrize("part", ["model", "author", "output"])
def test_signs_that_steer_a_terminal_do_nothing_in_any_line(
    part: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """Head and structure are as much the maker's words as the table of variables."""
    bad = "a\x1b[31m\ab"
    made = shown(own("x", causality="output"))
    described: Any = made.description
    if part == "output":
        described.outputs = [SimpleNamespace(variable=own(bad), dependencies=None)]
    else:
        setattr(described, {"model": "modelName", "author": "author"}[part], bad)
    show.show_fmu(made, is_all=False)
    text = capsys.readouterr().out
    assert "\x1b" not in text
    assert "\a" not in text
    assert "[31m" in text


def test_everything_that_an_fmu_can_do_is_in_the_head(capsys: pytest.CaptureFixture[str]) -> None:
    can: Any = SimpleNamespace(
        can_vary_step=True, can_save_state=False, can_serialize_state=False, can_return_early=True,
        fixed_step_s=0.002, once_per_process=True, needs_tool=True,
    )  # fmt: skip
    bare = shown()
    show.show_fmu(Shown(bare.archive, bare.description, can, []), is_all=False)
    lines = capsys.readouterr().out.splitlines()
    assert [one.split(maxsplit=1)[1] for one in lines if one.startswith("can ")] == [
        "take steps of any length: yes", "save and restore its state: no",
        "write its state as bytes: no", "return early from a step: yes",
        "internal step 0.002 s", "exist once in a process only",
        "run only with the tool that made it",
    ]  # fmt: skip
    show.show_fmu(bare, is_all=False)
    assert not any(one.startswith("can ") for one in capsys.readouterr().out.splitlines())
