"""What an entry of `manifest.json` may be, so that who reads it can rely on its type."""

import math
from typing import Any

import pytest

from axisrig.bench.campaign.results.manifest_form import wrong_entry

NO_COUNT = (-1, 1.0, True, "3", None, math.inf)
NO_TIME = (-0.5, math.inf, -math.inf, math.nan, True, "3", None)  # json.loads takes Infinity


@pytest.mark.parametrize(
    ("name", "right", "wrong"),
    [
        ("runs_planned", (0, 7), NO_COUNT),
        ("jobs", (1, 64), NO_COUNT),
        ("spent_s", (0, 0.0, 2.5, 3600), NO_TIME),
        ("finished", (True, False), (0, 1, "yes", None)),
        ("runs", ([], ["a", "b"]), (["a", 1], "a", None, ["a\x00"])),
        ("files", ({}, {"a": "f0"}), ({"a": 1}, [], None)),
        ("started", ("2026-01-01", None), (1, [], "a\x00")),
        ("python", ("3.12",), (None, 3)),
        ("missing", ({}, {"p": ["p-a"]}), ({"p": "p-a"}, {"p": [1]}, [])),
        (
            "earlier",
            ([], [{}], [{"command": ["axisrig"], "runs": ["p-a"], "started": None}]),
            (
                [{"command": "axisrig", "runs": ["p-a"]}],
                [{"command": ["axisrig"], "runs": [1]}],
                [{"command": ["axisrig"], "started": 3}],
                [{}, "p"],
                {},
            ),
        ),
        ("command", (["a"],), ("a", [1])),
        ("packages", ({"numpy": None},), ([], None)),
        ("fmus", ({"a.fmu": "f0"},), ({"a.fmu": None}, [])),
        ("drive_substituted", ({"p-a": "Z"},), ({"p-a": 1},)),
        ("axisrig", ("1.0", None), (1, [])),
        ("sources_sha256", ("f0",), (None, 1)),
        ("warnings", ([], ["a"]), ([1], "a")),
        ("merged", (["a", "b"],), ("a", [None])),
        ("recordings", ("../..",), ("..", "../../..", None)),
    ],
)
def test_an_entry_has_its_form_or_is_named(
    name: str, right: tuple[Any, ...], wrong: tuple[Any, ...]
) -> None:
    for value in right:
        assert wrong_entry({name: value}) is None, value
    for value in wrong:
        assert (wrong_entry({name: value}) or "").startswith(f"{name} is no "), value


@pytest.mark.parametrize("key", ["name", "path", "sha256"])
def test_a_plan_of_a_manifest_has_name_path_and_hash(key: str) -> None:
    plan = {"name": "p", "path": "p.csv", "sha256": "f0"}
    assert wrong_entry({"plans": [plan, plan]}) is None
    for other in ({**plan, key: 1}, {k: v for k, v in plan.items() if k != key}):
        assert (wrong_entry({"plans": [plan, other]}) or "").startswith("plans is no ")
