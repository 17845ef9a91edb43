"""Keys of a stamping terminal on an EtherCAT line, as `axisrig check` takes them."""

import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

TESTPLANS = Path(__file__).parents[2] / "testplans"


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ("[plc]\nclock_drift_ppm = 5", "drift_ppm = { terminal"),
        ("[plc.terminal]\nfilter_us = 5", "a terminal on an EtherCAT line has none"),
        ("[segment.ec1]\ndc = false", "stamps in the distributed clock"),
        ("[segment.ec1]\ndrift_ppm = { X = 5 }", "names no axis of it"),
    ],
)
def test_what_a_terminal_on_a_line_has_not_is_refused(
    place: Path, rejected: Callable[..., str], changes: str, says: str
) -> None:
    for folder in ("rigs", "plc"):
        shutil.copytree(TESTPLANS / folder, place / "plans" / folder)
    rig = place / "plans" / "rigs" / "own.toml"
    rig.write_text(f'base = "plc-timestamp-line.toml"\n{changes}\n')
    assert says in rejected("check", rig)


def test_a_terminal_on_can_needs_a_node(place: Path, rejected: Callable[..., str]) -> None:
    for folder in ("rigs", "plc"):
        shutil.copytree(TESTPLANS / folder, place / "plans" / folder)
    rig = place / "plans" / "rigs" / "own.toml"
    rig.write_text('base = "plc-timestamp.toml"\n[plc.terminal]\nsegment = "can1"\n')
    assert "needs a node number" in rejected("check", rig)


def test_an_assumed_instant_may_be_given_for_one_axis_of_several(
    place: Path, axisrig: Callable[..., tuple[int, str, str]]
) -> None:
    for folder in ("rigs", "plc"):
        shutil.copytree(TESTPLANS / folder, place / "plans" / folder)
    rig = place / "plans" / "rigs" / "own.toml"
    rig.write_text(
        'base = "probe-xyz-ethercat.toml"\n[segment.ec1]\nassumed_sample_us = { Z = -20 }\n'
    )
    assert axisrig("check", rig)[0] == 0
