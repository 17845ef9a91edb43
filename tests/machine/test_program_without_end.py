"""A program that does not end in its simulated time: its message, and how long it may take.

Places and values come from the programs below; the axis Z of the rig begins at 250 mm.
"""

from collections.abc import Callable
from pathlib import Path

import pytest

from axisrig.bench.campaign.single_program import run_program
from axisrig.kernel.errors import UserError

RIG = Path(__file__).parents[2] / "testplans" / "rigs" / "probe-xyz.toml"
GiveUp = Callable[..., str]


@pytest.fixture
def give_up(tmp_path: Path) -> GiveUp:
    """Run a program that does not end within 2 s; what is said."""

    def run(text: str, *assignments: str) -> str:
        program = tmp_path / "never.nc"
        program.write_text(text, encoding="utf-8")
        with pytest.raises(UserError) as caught:
            run_program(program, RIG, ["plc:limit_s=2", *assignments], (), lambda _: None)
        return str(caught.value)

    return run


@pytest.mark.long
@pytest.mark.parametrize(
    ("text", "line", "waits"),
    [
        ("G1 Z249 F3000\nN20 G4 4000\nM30", "line 2, block N20 (N20 G4 4000)", "4000 s"),
        ("N10 G1 Z240 F1\nM30", "line 1, block N10 (N10 G1 Z240 F1)", "Z 240 mm with 1 mm/min"),
        ("N5 M0\nM30", "line 1, block N5 (N5 M0)", "start of the operator"),
    ],
)
def test_the_block_and_what_it_waits_for_are_named(
    give_up: GiveUp, text: str, line: str, waits: str
) -> None:
    said = give_up(text, "plc:start_ms=1e8")
    assert "within 2 s of simulated time (plc:limit_s)" in said
    assert f"never.nc {line} waits for" in said
    assert waits in said


@pytest.mark.long
def test_the_loop_around_it_is_named(give_up: GiveUp) -> None:
    said = give_up(
        "N10 $WHILE V.E.GO == 0\nV.E.SEEN = 1\nN20 $ENDWHILE\nM30",
        "plc:V.E.GO=0",
        "plc:V.E.SEEN=0",
    )
    assert "(N10 $WHILE V.E.GO == 0) has made" in said
    assert "Z 250.000 mm" in said


def test_a_loop_that_waits_for_what_nothing_changes_ends_at_once(tmp_path: Path) -> None:
    program = tmp_path / "wait.nc"
    program.write_text("$WHILE V.E.GO == 0\n$ENDWHILE\nM30\n", encoding="utf-8")
    said = run_program(program, RIG, ["plc:V.E.GO=0"], (), lambda _: None)
    assert "ID 900126" in said[-1].text
    assert "wait.nc line 2" in said[-1].text


@pytest.mark.long
def test_alarms_of_the_channel_name_the_file(tmp_path: Path) -> None:
    """A probe that is low already (50052) and M0 without an operator (900170)."""
    program = tmp_path / "file.nc"
    low = "set:Z.kenngr.measure.edge=NEG"
    for block, alarm in (("N10 G100 Z240 F300", "50052"), ("N20 M0", "900170")):
        program.write_text(f"{block}\nM30\n", encoding="utf-8")
        said = run_program(program, RIG, [low], (), lambda _: None)
        (text,) = [each.text for each in said if f"ID {alarm}" in each.text]
        assert f"({program} line 1, block N" in text
