"""Rows of the machines of scenarios, and the rig of one with the profile that was drawn."""

import csv
from importlib import resources

import pytest

from axisrig.bench.tools.scenarios import machines as rows
from axisrig.bench.tools.scenarios.machines import (
    ALL,
    machines,
    machines_named,
    path_of,
    program_of,
    rig_of,
)
from axisrig.kernel.errors import UserError


def table() -> dict[str, dict[str, str]]:
    folder = resources.files(rows.__package__ or "")
    text = folder.joinpath("machines.csv").read_text(encoding="utf-8")
    return {row["machine"]: row for row in csv.DictReader(text.splitlines())}


def test_each_column_of_the_table_of_machines_is_in_its_own_field() -> None:
    """Blocks are numbers there, lists of words are tuples."""
    found = machines.__wrapped__()
    assert list(found) == list(table())
    for name, row in table().items():
        made = found[name]
        plain = ("title", "rig", "program", "inputs", "weights", "source")
        assert [getattr(made, field) for field in plain] == [row[field] for field in plain]
        assert made.name == name
        assert [f"N{block}" for block in made.prints] == row["prints"].split()
        for field, words in (("profiles", made.profiles), ("still", made.still)):
            assert list(words) == row[field].split(), (name, field)


KEPT = {"encoder_increments": 1_048_576, "lead_mm": 10.0, "input_delay_us": 500.0,
        "sync_loss_periods": 6, "heartbeat_ms": 20}  # fmt: skip
"""What the rig of the first machine says of its drive."""


@pytest.mark.parametrize("profile", ["epos4-like", "late-status"])
def test_a_drawn_profile_is_that_of_all_drives_without_what_it_does_to_a_latch(
    profile: str,
) -> None:
    """The oracle takes the motor one input delay after the edge; what the rig says stays."""
    plain, files = rig_of.__wrapped__("one-axis")
    assert plain.drive["servo"].model_dump()["profile"] == "generic"
    rig, same = rig_of.__wrapped__("one-axis", profile)
    assert (same, list(rig.axis), list(rig.plant)) == (files, list(plain.axis), list(plain.plant))
    (drive,) = rig.drive.values()
    found = drive.model_dump()
    assert found["profile"] == profile
    exact = {"latch": "interpolated", "latch_encoder": "motor", "input_jitter_us": 0.0,
             "input_filter_us": 0.0, "min_pulse_us": 0.0, "dead_time_us": 0.0,
             "delay_compensation_us": 0.0}  # fmt: skip
    for key, value in (KEPT | exact).items():
        assert found[key] == value, key
    assert {key: plain.drive["servo"].model_dump()[key] for key in KEPT} == KEPT


def test_files_are_beside_the_table_or_in_a_checkout(monkeypatch: pytest.MonkeyPatch) -> None:
    folder = rows.FOLDER
    assert path_of("probe.toml") == folder / "probe.toml"
    assert program_of("one-axis").axes == ("Z",)
    with pytest.raises(UserError, match="is not there") as caught:
        path_of("testplans/none.toml")
    assert caught.value.file == "testplans/none.toml"
    monkeypatch.setattr(rows, "FOLDER", folder / "programs")
    with pytest.raises(UserError, match="is not there"):
        path_of("probe.toml")


def test_a_machine_is_asked_for_by_its_name_or_all_of_them_are() -> None:
    names = list(machines())
    assert [row.name for row in machines_named("gantry")] == ["gantry"]
    assert [row.name for row in machines_named(ALL)] == names
    with pytest.raises(UserError, match="no such machine of the scenarios") as near:
        machines_named("gantri")
    assert "gantry" in str(near.value.allowed)
    assert names[0] not in str(near.value.allowed)
    with pytest.raises(UserError, match="no such machine of the scenarios") as far:
        machines_named("0123456789")
    assert [name for name in (*names, ALL) if name not in str(far.value.allowed)] == []
    assert far.value.value == "0123456789"
