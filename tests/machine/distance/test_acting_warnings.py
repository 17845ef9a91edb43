"""Warnings of instability are about the control that acted: its mode, its kp, whoever set it.

With the list of the shipped rig (mean of 4, two dead cycles) CONST_DIST is stable below 0.431 and
SET_POS below 2, both closed forms of docs/distance-control.md.
"""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from axisrig.bench.campaign.checking import check_file
from axisrig.bench.campaign.single_program import run_program

RunDistance = Callable[..., Any]
TESTPLANS = Path(__file__).parents[3] / "testplans"
CONST = "Z[DIST_CTRL ON CONST_DIST SET_DIST=2]"
SURFACE = "Z[DIST_CTRL ON SET_POS=30]"
LISTED_1 = "set:Z.kenngr.distc.kp=1"
KP_1 = "plc:Z.object.DIST_CTRL::kp=1 at=20ms"


def found(run_distance: RunDistance, blocks: str, *assignments: str) -> list[str]:
    lines = [f"N{10 * n} {word}" for n, word in enumerate(blocks.split("; "), 1)]
    facts = run_distance("\n".join(lines), *assignments).outcome.facts
    return [note.text for note in facts.notes if note.source == "distance"]


@pytest.mark.parametrize(
    ("blocks", "assignments"),
    [
        pytest.param(f"{SURFACE}; G4 0.05", (LISTED_1,), id="a mode that bears the listed kp"),
        pytest.param(f"Z[DIST_CTRL KP=0.2]; {CONST}; G4 0.05", (LISTED_1,), id="programmed lower"),
        pytest.param(
            "Z[DIST_CTRL DRYRUN CONST_DIST SET_DIST=2]; G4 0.05", (LISTED_1,), id="a dry run"
        ),
        pytest.param("G4 0.05", (LISTED_1,), id="never on"),
        pytest.param(f"{CONST}; G4 0.05", (KP_1,), id="written and not taken over"),
    ],
)
def test_what_nobody_uses_is_not_warned_of(
    run_distance: RunDistance, blocks: str, assignments: tuple[str, ...]
) -> None:
    assert found(run_distance, blocks, *assignments) == []


@pytest.mark.parametrize(
    ("blocks", "assignments"),
    [
        pytest.param(f"{CONST}; G4 0.05", (LISTED_1,), id="listed"),
        pytest.param(f"Z[DIST_CTRL KP=1]; {CONST}; G4 0.05", (), id="programmed"),
        pytest.param(f"{CONST}; Z[DIST_CTRL KP=1]; G4 0.05", (), id="programmed while on"),
        pytest.param(f"G4 0.05; {CONST}; G4 0.05", (KP_1,), id="written by the PLC side"),
    ],
)
def test_what_acts_beyond_its_limit_is_warned_of_once(
    run_distance: RunDistance, blocks: str, assignments: tuple[str, ...]
) -> None:
    (warning,) = found(run_distance, blocks, *assignments)
    assert warning.startswith("axis Z: CONST_DIST by gap on 60E4:1, TPDO4 with every SYNC is unst")
    assert "with kp 1 (P-AXIS-00759): its limit is 0.431 with 2 dead cycles" in warning


@pytest.mark.long
def test_what_a_plant_lacks_stands_in_check_and_log_and_not_before_a_result(
    run_distance: RunDistance,
) -> None:
    rig = TESTPLANS / "rigs" / "distance-z.toml"
    lacking = "no force: the actual torque of the drive stays 0"
    assert lacking in check_file(rig)
    facts = run_distance("N10 G4 0.01").outcome.facts
    assert f"plant z: {lacking}" in [n.text for n in facts.notes if n.source == "lacking"]
    program = TESTPLANS / "programs" / "dist-2.nc"
    notes = run_program(program, rig, [], [], lambda _text: None)
    assert [note.text for note in notes if note.text.startswith("plant ")] == []
