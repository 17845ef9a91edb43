"""Findings on a model description: start values, units, capabilities."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from tests.fmu_tools.described import texts, variable

from axisrig.bench.tools.fmu import examine
from axisrig.bench.tools.fmu.binaries import Binary
from axisrig.bench.tools.fmu.findings import Level

FMU = Path("a.fmu")


@pytest.mark.parametrize(
    ("given", "text"),
    [
        ({"start": "1"}, None),
        ({"start": "1", "min": "1", "max": "1"}, None),
        ({"start": "0.5", "min": "1"}, "v = 0.5 (1 .. inf)"),
        ({"start": "2", "max": "1"}, "v = 2 (-inf .. 1)"),
        ({"start": "1 5 2", "max": "3"}, "v = 5 (-inf .. 3)"),
        ({"start": "2", "max": "1", "causality": "local"}, None),
        ({"start": "2", "max": "1", "type": "String"}, None),
        ({"max": "1"}, None),
        ({"start": "2", "max": "1", "type": "UInt8"}, "v = 2 (-inf .. 1)"),
    ],
)
def test_a_start_value_outside_its_limits_is_named(given: dict[str, Any], text: str | None) -> None:
    assert examine._out_of_range(variable("v", **given)) == text


@pytest.mark.parametrize(("is_here", "level"), [(True, Level.FAIL), (False, Level.WARN)])
def test_a_library_of_another_platform_is_a_fault_where_it_is_to_be_loaded(
    is_here: bool, level: Level
) -> None:
    """In the folder of another platform it does not matter here."""
    binary = Binary("x86_64-windows", "a.dll", "linux", ("aarch64",))
    found = examine._misplaced(binary, is_here=is_here)
    assert (found.area, found.level) == ("platforms", level.value)
    assert found.text.startswith("x86_64-windows says x86_64 on windows, its library is")


def test_of_many_names_six_are_shown() -> None:
    names = [f"v{n}" for n in range(8)]
    assert examine._some(names[:6]) == "v0, v1, v2, v3, v4, v5"
    assert examine._some(names) == "v0, v1, v2, v3, v4, v5 and 2 more"


@pytest.mark.parametrize(
    ("units", "warnings", "good"),
    [
        ({"a": "m", "b": "m/s"}, [], ["known: m, m/s"]),
        ({}, [], ["nothing has one"]),
        ({"a": "m", "b": None}, ["without a unit: b"], []),
        ({"a": "furlong", "b": None}, ["units not known: furlong", "without a unit: b"], []),
    ],
)
def test_units_of_inputs_and_outputs_are_looked_at(
    units: dict[str, str | None], warnings: list[str], good: list[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    monkeypatch.setattr(examine, "unit_name", lambda v: units.get(v.name))
    monkeypatch.setattr(examine, "find_unit", lambda _, name: None if name == "furlong" else name)
    beside = [variable("c", causality="local"), variable("d", type="Boolean")]
    found = list(examine._units(None, [*map(variable, units), *beside]))  # type: ignore[arg-type]
    assert (texts(found, "warn"), texts(found, "ok")) == (warnings, good)


@pytest.mark.parametrize("missing", ["", "vary", "tool", "once", "state"])
def test_each_capability_that_is_missing_is_a_warning(
    missing: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    can = SimpleNamespace(
        can_save_state=missing != "state", can_serialize_state=False, can_return_early=True,
        can_vary_step=missing != "vary", needs_tool=missing == "tool",
        once_per_process=missing == "once",
    )  # fmt: skip
    monkeypatch.setattr(examine, "Capabilities", SimpleNamespace(of=lambda *_: can))
    said, *warnings = examine._capabilities(None, FMU)  # type: ignore[arg-type]
    assert said.text == (
        f"saves its state: {'no' if missing == 'state' else 'yes'}; serialises it: no; returns"
        f" early: yes; takes steps of any length: {'no' if missing == 'vary' else 'yes'}"
    )
    words = {"vary": "one length only", "tool": "needs the tool", "once": "once in a process",
             "state": "cannot be saved"}  # fmt: skip
    assert len(warnings) == bool(missing)
    assert all(words[missing] in one.text and one.level == "warn" for one in warnings)
