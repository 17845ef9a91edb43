"""Families of drives and their carriers, and the family that a list of an axis names."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from pydantic import ValidationError

from axisrig.bench.rig.cyclic.on_segment import OF_FAMILY, on_segment
from axisrig.bench.rig.reading import families, file

ROWS = [SimpleNamespace(family=family, carrier=carrier) for family, carrier in
        (("a", "x"), ("a", "y"), ("b", "y"), ("b", "z"))]  # fmt: skip


def test_a_family_has_its_carriers_and_both_together_a_row(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(families, "FAMILIES", ROWS)
    assert [families.carriers_of(name) for name in "abc"] == [["x", "y"], ["y", "z"], []]
    assert [families.joined(*pair) for pair in (("a", "y"), ("b", "y"), ("a", "z"))] == [
        ROWS[1], ROWS[2], None,
    ]  # fmt: skip
    by_carrier = [row.carrier for row in ROWS]
    for values, row in (({"carrier": "y"}, ROWS[1]), ({}, ROWS[0]), (None, ROWS[0])):
        assert families._row(values, "carrier", by_carrier) is row
    for word in ("w", "", 0, False):
        with pytest.raises(ValidationError) as caught:
            families._row({"carrier": word}, "carrier", by_carrier)
        (error,) = caught.value.errors()
        assert (error["loc"], error["input"]) == (("carrier",), word)
        assert error["msg"].startswith("there is no such carrier; allowed: ")


def test_a_drive_takes_the_family_that_a_list_of_its_axes_names(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A family that the rig itself names stays, and where there is one only nothing is chosen."""
    listed = {"x.lst": "", "y.lst": "b", "z.lst": "a"}
    monkeypatch.setattr(file, "_listed_family", lambda path: listed.get(str(path), ""))
    wired = (("x", "one"), ("y", "one"), ("z", "two"), ("w", "three"))
    axes = {name: {"drive": drive, "list": f"{name}.lst"} for name, drive in wired}

    def named(rows: Any) -> dict[str, str | None]:
        monkeypatch.setattr(file, "FAMILIES", rows)
        drives: dict[str, Any] = {name: {} for name in ("one", "two", "three")}
        drives["own"] = {"family": "b"}
        table = {"drive": drives, "axis": {**axes, "v": {"drive": "own", "list": "z.lst"}}}
        file._name_families(table)
        return {name: drive.get("family") for name, drive in drives.items()}

    assert named(ROWS) == {"one": "b", "two": "a", "three": None, "own": "b"}
    assert named(ROWS[:2]) == {"one": None, "two": None, "three": None, "own": "b"}


def test_a_family_that_a_list_names_counts_only_where_its_segment_carries_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Of two axes of a drive the first one whose segment carries its family. A segment without a
    carrier is one of the first row's; one that the rig does not have is refused elsewhere."""
    monkeypatch.setattr(file, "_listed_family", lambda path: str(path)[0])
    monkeypatch.setattr(file, "FAMILIES", ROWS)
    monkeypatch.setattr(families, "FAMILIES", ROWS)
    segments = {name: {"carrier": name} for name in "xyz"} | {"plain": {}}
    for wired, family in (
        ([("b", "x")], None), ([("b", "y")], "b"), ([("a", "z")], None), ([("a", "plain")], "a"),
        ([("b", "plain")], None), ([("b", "gone")], "b"), ([("b", "x"), ("a", "y")], "a"),
        ([("a", "y"), ("b", "z")], "a"),
    ):  # fmt: skip
        axes = {
            f"A{number}": {"drive": "one", "list": f"{of}.lst", "segment": segment}
            for number, (of, segment) in enumerate(wired)
        }
        for keys in ({}, {"as_canopen": True}):
            drive: dict[str, Any] = dict(keys)
            file._name_families({"drive": {"one": drive}, "axis": axes, "segment": segments})
            assert drive.get("family") == (None if keys else family), wired


def test_each_axis_of_a_cyclic_segment_is_of_the_family_of_its_own_drive() -> None:
    """All on one segment, two with one drive, and two drives of a family in turn."""
    wired = [(f"{name}{number}", name) for number in (1, 2) for name in OF_FAMILY]
    drives = {name: SimpleNamespace(family_name=family) for name, family in wired}
    axes = {f"of_{name}": SimpleNamespace(drive=name, segment="fast") for name, _ in wired}
    axes["again"] = axes["of_lightbus2"]
    settings: Any = SimpleNamespace(rig=SimpleNamespace(axis=axes, drive=drives))
    for axis in axes:
        family = drives[axes[axis].drive].family_name
        assert on_segment(settings, axis) is OF_FAMILY[family]
        found = OF_FAMILY[family]
        names = [made.__name__ for made in (found.check, found.describe)]
        assert names == [f"check_{family}", f"describe_{family}"]


@pytest.mark.parametrize(
    ("types", "family"),
    [((None, 2), "sercos"), ((2, None), "sercos"), ((8, 2), "canopen"), ((None, None), None)],
)
def test_a_list_that_names_no_drive_type_says_nothing_of_the_family(
    tmp_path: Path, types: tuple[int | None, ...], family: str | None
) -> None:
    """P-AXIS-00020: 2 SERCOS, 8 CANopen; of two axes of one drive on a line."""
    axes = {}
    for number, kind in enumerate(types):
        path = tmp_path / f"{number}.lst"
        path.write_text("" if kind is None else f"kenngr.antr_typ {kind}\n", encoding="utf-8")
        axes[f"A{number}"] = {"drive": "one", "list": str(path), "segment": "line"}
    drive: dict[str, Any] = {}
    segments = {"line": {"carrier": "ethercat"}}
    file._name_families({"drive": {"one": drive}, "axis": axes, "segment": segments})
    assert drive.get("family") == family
