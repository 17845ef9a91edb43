"""`axisrig check RIG`: the order of what it reports, warnings, and that the plant is closed."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.campaign import checking
from axisrig.bench.campaign.checking import check_file
from axisrig.kernel.errors import UserError

RIG = Path("r.toml")
BARE = {"plant:z.x": ("m", ("plant:z.x_mm", "plant:z.x_um")), "plant:z.y": ("s", ("plant:z.y_ms",))}


class Parts:
    """Stands in for the parts that describe a rig and its plant."""

    def __init__(self, patch: pytest.MonkeyPatch, *, is_quiet: bool = False) -> None:
        self.done: list[str] = []
        self.wrong = ""
        self.changes: list[str] = []

        def lines(*texts: str) -> list[str]:
            return [] if is_quiet else list(texts)

        settings = SimpleNamespace(
            bare=BARE, bare_in_rig={}, files=[RIG], warnings=lines("of lists"),
            notes=lines("noted"),
        )  # fmt: skip

        def read_settings(_rig: Any, _files: Any, changes: Any) -> Any:
            self.changes = [item.column for item, _ in changes]
            return settings

        def family(name: str) -> Any:
            return SimpleNamespace(
                tables=lambda _: [f"table of {name}"], describe=lambda _: [f"bus of {name}"],
                warn=lambda _: lines(f"warned by {name}"),
            )  # fmt: skip

        patch.setattr(checking, "read_rig", lambda path: (SimpleNamespace(title="a rig"), [path]))
        patch.setattr(checking, "read_settings", read_settings)
        patch.setattr(checking, "check_rig", self._step("check_rig"))
        patch.setattr(checking, "build_plant", lambda _: "plant")
        for name in ("check_plants", "start_plant", "close_plant"):
            patch.setattr(checking, name, self._step(name))
        patch.setattr(checking, "describe_plants", lambda *_: ["plant z"])
        patch.setattr(checking, "printed_log", lambda _: ["it printed"])
        patch.setattr(checking, "describe_distance", lambda *_: ["loop one", "loop two"])
        patch.setattr(checking, "drive_lags_s", lambda *_: {})
        patch.setattr(checking, "rig_families", lambda: [family("can"), family("ec")])
        patch.setattr(checking, "distance_warnings", lambda _: lines("of distance"))
        patch.setattr(checking, "age_warnings", lambda _: lines("of ages"))
        patch.setattr(checking, "describe_axes", lambda _: ["axis X", "axis Z"])

    def _step(self, name: str) -> Any:
        def step(*_: object) -> None:
            self.done.append(name)
            if name == self.wrong:
                raise UserError("broken")

        return step


def bare(column: str, value: str, unit: str, named: str) -> str:
    return f"{column} names no unit, so {value} counts in {unit}; with a unit: {named}"


OF_X = bare("plant:z.x", "5", "m", "plant:z.x_mm or plant:z.x_um")
OF_Y = bare("plant:z.y", "6", "s", "plant:z.y_ms")


def test_a_rig_is_described_from_its_axes_to_its_plants(monkeypatch: pytest.MonkeyPatch) -> None:
    """Warnings of the lists come before notes, those of values and of parts after them."""
    parts = Parts(monkeypatch)
    text = check_file(RIG, ["plant:z.x=5", "set:Z.a=1", "plant:z.y=6"])
    assert parts.changes == ["plant:z.x", "set:Z.a", "plant:z.y"]
    head, axes, *others = text.split("\n\n")
    assert head == "r.toml: a rig"
    assert axes.splitlines() == [
        *("axis X", "axis Z", "bus of can", "bus of ec"),
        *("warning: of lists", "note: noted", f"warning: {OF_X}", f"warning: {OF_Y}"),
        *("warning: warned by can", "warning: warned by ec"),
        *("warning: of distance", "warning: of ages"),
    ]
    assert others == [
        "loop one", "loop two", "table of can", "table of ec", "plant z\nit printed",
    ]  # fmt: skip
    assert parts.done == ["check_rig", "check_plants", "start_plant", "close_plant"]


@pytest.mark.parametrize("wrong", ["check_plants", "start_plant"])
def test_a_plant_is_closed_also_where_it_is_refused(
    monkeypatch: pytest.MonkeyPatch, wrong: str
) -> None:
    parts = Parts(monkeypatch)
    parts.wrong = wrong
    with pytest.raises(UserError, match="broken"):
        check_file(RIG)
    assert parts.done[-2:] == [wrong, "close_plant"]


def test_with_strict_each_kind_of_warning_rejects_a_rig(monkeypatch: pytest.MonkeyPatch) -> None:
    Parts(monkeypatch)
    with pytest.raises(UserError) as caught:
        check_file(RIG, ["plant:z.y=6"], is_strict=True)
    assert [one.message for one in (caught.value, *caught.value.further)] == [
        "of lists", OF_Y, "warned by can", "warned by ec", "of distance", "of ages",
    ]  # fmt: skip
    Parts(monkeypatch, is_quiet=True)
    assert "warning" not in check_file(RIG, is_strict=True)
    with pytest.raises(UserError, match="names no unit"):
        check_file(RIG, ["plant:z.x=5"], is_strict=True)
