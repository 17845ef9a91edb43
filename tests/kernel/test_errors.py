"""The alarm catalogue: documented IDs and classes by hand, texts and values against each other."""

import ast
import csv
import pickle
import string
from pathlib import Path

import pytest

import kernel
from kernel.errors import Alarm, CatalogueEntry, UserError, catalogue, nearest

KERNEL = Path(kernel.__path__[0])
ENTRIES = list(catalogue().values())
OURS = "axisrig (no ID documented)"

# Classes as the diagnosis manual prints them.
DOCUMENTED = {
    20008: 2,
    20138: 2,
    20772: 2,
    50052: 4,
    50059: 4,
    50061: 4,
    70082: 5,
    70383: 1,
    70384: 1,
    70385: 1,
    110586: 1,
}


def test_ids_are_unique_and_sorted() -> None:
    with (KERNEL / "errors.csv").open(encoding="utf-8", newline="") as file:
        ids = [int(row["id"]) for row in csv.DictReader(file)]
    assert ids == sorted(set(ids))


def test_documented_ids_have_the_documented_class() -> None:
    found = {e.id: e.reaction_class for e in ENTRIES if e.source != OURS}
    assert found == DOCUMENTED


def test_ours_and_only_ours_start_at_900000() -> None:
    assert {e.id for e in ENTRIES if e.source == OURS} == {e.id for e in ENTRIES if e.id >= 900000}


def test_the_columns_have_no_other_values() -> None:
    with (KERNEL / "errors.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert {row["raised"] for row in rows} <= {"yes", "no"}
    assert {word for row in rows for word in row["inferred"].split()} <= set(rows[0])
    assert [row["id"] for row in rows if not row["area"] or None in row] == []


def test_one_reaction_per_class() -> None:
    pairs = {(e.reaction_class, e.reaction) for e in ENTRIES}
    assert len(pairs) == len({reaction_class for reaction_class, _ in pairs})
    assert {reaction_class for reaction_class, _ in pairs} <= set(range(1, 8))


@pytest.mark.parametrize("entry", ENTRIES, ids=lambda entry: str(entry.id))
def test_text_uses_exactly_its_values(entry: CatalogueEntry) -> None:
    used = {name for _, name, _, _ in string.Formatter().parse(entry.text) if name is not None}
    assert used == set(entry.values)
    assert len(entry.values) == len(set(entry.values))
    assert entry.text
    assert not entry.text.endswith(".")
    assert entry.remedy.endswith(".")


@pytest.mark.parametrize("entry", ENTRIES, ids=lambda entry: str(entry.id))
def test_alarm_shows_id_class_and_every_value(entry: CatalogueEntry) -> None:
    values = {name: f"<{name}>" for name in entry.values}
    shown = str(Alarm(entry.id, place="N30", **values))
    assert shown.startswith(f"ID {entry.id} class {entry.reaction_class}: ")
    assert all(value in shown for value in values.values())
    assert "(N30)" in shown
    assert Alarm(entry.id, **values).ends_program is (entry.reaction_class > 1)


def raised() -> list[tuple[str, int, set[str]]]:
    """Find every `Alarm(<number>, name=...)` in the sources of the kernel."""
    calls = []
    for path in sorted(KERNEL.rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if (
                isinstance(node, ast.Call)
                and isinstance(node.func, ast.Name)
                and node.func.id == "Alarm"
                and node.args
                and isinstance(node.args[0], ast.Constant)
                and isinstance(node.args[0].value, int)
            ):
                names = {word.arg for word in node.keywords if word.arg}
                calls.append((f"{path.name}:{node.lineno}", node.args[0].value, names))
    return calls


def test_every_entry_is_provoked_by_a_test() -> None:
    """Its ID stands in a test beside the expectation that it comes up."""
    here = Path(__file__)
    others = [path for path in here.parents[1].rglob("test_*.py") if path != here]
    texts = "\n".join(path.read_text(encoding="utf-8") for path in others)
    assert [e.id for e in ENTRIES if e.is_raised and str(e.id) not in texts] == []


def test_every_alarm_of_the_kernel_is_in_the_catalogue_with_its_values() -> None:
    calls = raised()
    assert calls
    for place, alarm_id, names in calls:
        assert alarm_id in catalogue(), f"{place}: {alarm_id}"
        assert set(catalogue()[alarm_id].values) <= names, f"{place}: {alarm_id}"


def test_a_guess_is_told_as_a_guess_also_when_the_error_is_told_again() -> None:
    error = UserError("no such thing", value="drip", allowed=nearest("drip", ["drop", "alter"]))
    assert str(error) == "no such thing; found 'drip'; did you mean: drop"
    again = pickle.loads(pickle.dumps(UserError("again", allowed=error.allowed)))
    assert again.allowed == "drop"
    assert str(UserError("told", allowed=again.allowed)) == "told; did you mean: drop"
    assert str(UserError("few", allowed=["drop"])) == "few; allowed: drop"
