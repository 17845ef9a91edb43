"""The alarm catalogue: documented IDs and classes by hand, texts and values against each other."""

import ast
import csv
import pickle
import string
from pathlib import Path

import pytest

import axisrig.kernel
from axisrig.kernel.errors import (
    OF_PARAMETER_LISTS,
    Alarm,
    CatalogueEntry,
    UserError,
    catalogue,
    nearest,
)

KERNEL, BENCH = Path(axisrig.kernel.__path__[0]), Path(axisrig.bench.__path__[0])
ENTRIES = list(catalogue().values())
OURS = "axisrig (no ID documented)"

# Classes as the manuals print them: the diagnosis manual, and FCT-C4 for 51026.
DOCUMENTED = {
    1: "70383 70384 70385 110547 110586 110604 110657 110658 110757"
    " 315000 315001 315002 315003 315004 315005 315008 315010 315011 315012",
    2: "20008 20138 20209 20772 20956 21837 21964 21968 22096 22142 22349 22356 50718 51026",
    4: "50050 50052 50059 50061 50637 50664",
    5: "70082",
    6: "60207",
    7: "51062 70335 70440 70516 70521 70689 310000 310001 310003 310004 310005 310009 310010 310011"
    " 310014 310015 310017 310018 310024 310025 310027 310028 310029",
}
# What the seeds and the diagnosis manual name, and no class stands beside it.
INFERRED = {
    13413, 13414, 13425, 44011, 50573, 70329, 70330, 70331, 70332, 70333, 70334, 70336, 70576,
    110608, 110611, 110612, 110622, 310002, 310006, 310007, 310008, 310012, 310013, 310016, 310019,
    310020, 310021, 310022, 310023, 310026, 310030, 315006, 315007, 315009,
}  # fmt: skip
FAMILIES = {
    70329: 310018, 70330: 310019, 70331: 310017, 70335: 310024, 70336: 310015, 70440: 310025,
    70516: 310011, 70521: 310005, 70576: 310020, 110604: 315000, 110757: 110657,
}  # fmt: skip


def test_ids_are_unique_and_sorted() -> None:
    with (KERNEL / "errors.csv").open(encoding="utf-8", newline="") as file:
        ids = [int(row["id"]) for row in csv.DictReader(file)]
    assert ids == sorted(set(ids))


def test_documented_ids_have_the_documented_class() -> None:
    """What the other parts have looked up since is said by the tests that provoke it."""
    for reaction_class, ids in DOCUMENTED.items():
        found = {i: catalogue()[i].reaction_class for i in map(int, ids.split())}
        assert set(found.values()) == {reaction_class}
        assert [i for i in found if "class" in catalogue()[i].inferred] == [
            i for i in found if i in (70383, 70384)
        ]


def test_a_class_that_nobody_documents_is_marked() -> None:
    assert {i for i in INFERRED if "class" not in catalogue()[i].inferred} == set()


def test_either_spelling_of_a_family_leads_to_the_other() -> None:
    assert {e.id: e.newer_id for e in ENTRIES if e.newer_id} == FAMILIES
    assert {e.older_id: e.id for e in ENTRIES if e.older_id} == FAMILIES
    for older, newer in FAMILIES.items():
        assert catalogue()[older].family == catalogue()[newer].family == (older, newer)
        assert catalogue()[older].text == catalogue()[newer].text
        assert catalogue()[older].reaction_class == catalogue()[newer].reaction_class


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
    has_program = entry.error_type != OF_PARAMETER_LISTS
    assert Alarm(entry.id, **values).ends_program is (entry.reaction_class > 1 and has_program)


def _name(function: ast.expr) -> str:
    return getattr(function, "id", None) or getattr(function, "attr", "")


def raised() -> list[tuple[str, int, set[str]]]:
    """Find every `Alarm(<number>, name=...)`, also by `context.alarm`, in the sources."""
    calls = []
    for path in sorted([*KERNEL.rglob("*.py"), *BENCH.rglob("*.py")]):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if (
                isinstance(node, ast.Call)
                and _name(node.func) in ("Alarm", "alarm")
                and node.args
                and isinstance(node.args[0], ast.Constant)
                and isinstance(node.args[0].value, int)
            ):
                names = {word.arg or "**" for word in node.keywords}
                calls.append((f"{path.name}:{node.lineno}", node.args[0].value, names))
    return calls


@pytest.mark.long
def test_every_alarm_of_the_kernel_is_in_the_catalogue_with_its_values() -> None:
    calls = raised()
    assert calls
    for place, alarm_id, names in calls:
        assert alarm_id in catalogue(), f"{place}: {alarm_id}"
        missing = set(catalogue()[alarm_id].values) - names
        assert not missing or "**" in names, f"{place}: {alarm_id} without {missing}"


def test_a_guess_is_told_as_a_guess_also_when_the_error_is_told_again() -> None:
    error = UserError("no such thing", value="drip", allowed=nearest("drip", ["drop", "alter"]))
    assert str(error) == "no such thing; found 'drip'; did you mean: drop"
    again = pickle.loads(pickle.dumps(UserError("again", allowed=error.allowed)))
    assert again.allowed == "drop"
    assert str(UserError("told", allowed=again.allowed)) == "told; did you mean: drop"
    assert str(UserError("few", allowed=["drop"])) == "few; allowed: drop"
