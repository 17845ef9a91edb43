"""`axisrig params`: what two lists differ in by what acts, and notes behind the values of a rig."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.tools.params import effective
from axisrig.bench.tools.params.effective import difference_text, effective_text
from axisrig.kernel.errors import UserError

HEAD = "kopf.achs_nr 1\nkopf.log_achs_name {}\n"
STEP = "getriebe[0].lslope_profil.a_stufe_1"


def listed(folder: Path, name: str, *lines: str) -> Path:
    path = folder / f"{name}.lst"
    path.write_text("\n".join([*lines, ""]), encoding="utf-8")
    return path


def axis(folder: Path, name: str, *lines: str) -> Path:
    return listed(folder, name, HEAD.format(name).strip(), *lines)


def differences(left: Path, right: Path) -> list[str]:
    text, differs = difference_text(left, right)
    lines = text.splitlines()
    assert differs is (lines != ["no difference"])
    if differs:
        assert lines[:2] == [f"--- {left}", f"+++ {right}"]
    return lines[2:]


def test_what_follows_from_a_value_that_differs_is_a_difference_too(tmp_path: Path) -> None:
    """P-AXIS-00282 is P-AXIS-00011 while it is 0, so both differ; where it is set it does not."""
    first, second = (axis(tmp_path, "Z", f"{STEP} 500"), tmp_path / "other.lst")
    second.write_text(HEAD.format("Z") + f"{STEP} 777\n")
    follows = STEP.replace(".a_", ".d_")
    assert differences(first, second) == [
        f"Z: {STEP}: 500 mm/s2 -> 777 mm/s2", f"Z: {follows}: 500 mm/s2 -> 777 mm/s2",
    ]  # fmt: skip
    for path in (first, second):
        path.write_text(path.read_text() + f"{follows} 600\n")
    assert differences(first, second) == [f"Z: {STEP}: 500 mm/s2 -> 777 mm/s2"]


def test_each_gear_of_an_axis_is_compared_with_what_acts_in_the_other_list(
    tmp_path: Path,
) -> None:
    """One list has a second gear: the other one has its default there."""
    key = STEP.replace("[0]", "[1]")
    first, second = tmp_path / "a.lst", axis(tmp_path, "Z", f"{key} 555")
    first.write_text(HEAD.format("Z"))
    assert f"Z: {key}: 1000 mm/s2 -> 555 mm/s2" in differences(first, second)
    assert f"Z: {key}: 555 mm/s2 -> 1000 mm/s2" in differences(second, first)
    assert not [line for line in differences(first, second) if f" {STEP}:" in line]


@pytest.mark.parametrize(("other", "name"), [("X", "Z, X"), ("Z", "Z")])
def test_lists_of_one_axis_each_are_compared_whatever_their_names(
    tmp_path: Path, other: str, name: str
) -> None:
    folder = tmp_path / "other"
    folder.mkdir()
    first, second = axis(tmp_path, "Z"), axis(folder, other, "getriebe[0].window 250")
    found = differences(first, second)
    assert [line.partition(": ")[0] for line in found] == [name] * len(found)
    assert len(found) == (2 if name != "Z" else 1)  # kopf.log_achs_name is another one


def test_lists_of_several_axes_are_compared_by_their_names(tmp_path: Path) -> None:
    both = listed(tmp_path, "both", *HEAD.format("X").split("\n"),
                  "kopf.achs_nr 2\nkopf.log_achs_name Y")  # fmt: skip
    one = axis(tmp_path, "Y")
    assert differences(both, one) == [f"X: only in {both}", "Y: kopf.achs_nr: 2 -> 1"]
    assert differences(one, both) == ["Y: kopf.achs_nr: 1 -> 2", f"X: only in {both}"]


def test_a_rig_and_a_list_have_nothing_to_compare(tmp_path: Path) -> None:
    for left, right in (("a.toml", "b.lst"), ("a.lst", "b.TOML")):
        with pytest.raises(UserError, match="compared by nothing"):
            difference_text(tmp_path / left, tmp_path / right)


@pytest.mark.parametrize(
    ("warnings", "notes", "tail"),
    [
        ((), (), []),
        (("w1", "w2"), (), ["", "warning: w1", "warning: w2"]),
        ((), ("n1", "n2"), ["", "note: n1", "note: n2"]),
        (("w1",), ("n1",), ["", "warning: w1", "note: n1"]),
    ],
)
def test_warnings_and_notes_of_a_rig_are_behind_its_values(
    monkeypatch: pytest.MonkeyPatch, warnings: tuple[str, ...], notes: tuple[str, ...],
    tail: list[str],
) -> None:  # fmt: skip
    rig: Any = SimpleNamespace(warnings=warnings, notes=notes)
    monkeypatch.setattr(effective, "settings_of", lambda *_: rig)
    monkeypatch.setattr(effective, "parts_of", lambda _, axis: axis)
    monkeypatch.setattr(effective, "blocks_text", lambda axis, words: [f"{axis} {words}"])
    text = effective_text(Path("a.toml"), "Z", ["feed"], [])
    assert text.splitlines() == ["Z ['feed']", *tail]
    monkeypatch.setattr(effective, "blocks_text", lambda *_: [])
    with pytest.raises(UserError, match="no parameter of the rig fits") as nothing:
        effective_text(Path("a.toml"), None, ["feed", "kp"], [])
    assert nothing.value.value == "feed kp"
