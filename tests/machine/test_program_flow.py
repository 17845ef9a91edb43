"""A program with a subprogram, loops, own variables and a value for the PLC side, on a rig."""

from collections.abc import Callable
from pathlib import Path

import pytest
from tests.machine.conftest import Outcome

from axisrig.bench.campaign.single_program import run_program

PLANS = Path(__file__).parents[2] / "testplans"
RIG = PLANS / "rigs" / "probe-xyz.toml"


def run(program: Path, *assignments: str) -> tuple[list[str], list[str]]:
    """Run a program; what it put out, and what was said of the run."""
    texts: list[str] = []
    ended = run_program(program, RIG, assignments, (), texts.append)
    return texts, [each.text for each in ended]


@pytest.fixture(scope="module")
def mean() -> tuple[list[str], list[str]]:
    return run(PLANS / "programs" / "probe-mean.nc", "plc:V.E.MEAN=0")


@pytest.mark.long
def test_three_touches_meet_the_top_of_the_workpiece(mean: tuple[list[str], list[str]]) -> None:
    """The rig's workpiece ends at Z = 100 mm; the latch sees it to 0.1 um."""
    (text,), _ = mean
    value_mm = float(text.removeprefix("mean of three: ").removesuffix(" mm"))
    assert value_mm == pytest.approx(100.0, abs=1e-4)


@pytest.mark.long
def test_the_plc_side_has_the_mean_afterwards(mean: tuple[list[str], list[str]]) -> None:
    _, said = mean
    (line,) = [text for text in said if "V.E.MEAN" in text]
    value_mm = float(line.split("V.E.MEAN = ")[1].split()[0])
    assert value_mm == pytest.approx(100.0, abs=1e-4)
    assert "block N190" in line


@pytest.mark.long
def test_a_word_that_does_not_act_ends_the_program_when_the_machine_gets_there(
    tmp_path: Path,
) -> None:
    program = tmp_path / "later.nc"
    program.write_text(
        'G1 G90 Z110 F3000\n#MSG SYN ["there %f", V.A.ABS.Z]\nG41\nZ50\n', encoding="utf-8"
    )
    texts, said = run(program)
    assert texts == ["there 110.000000"]
    assert "ID 900100" in said[-1]


@pytest.mark.long
def test_the_block_trace_follows_loop_subprogram_and_branch(
    run_own: Callable[..., Outcome], tmp_path: Path
) -> None:
    """Each turn has its rows, those of the subprogram with lines of their own."""
    program = """%L UP
N100 G1 Z129 F6000
N110 M17
%MAIN
N10 $FOR P1 = 0, 2, 1
N20 $IF P1 == 1
N30 G4 0.01
N40 $ELSE
N50 LL UP
N60 $ENDIF
N70 G1 Z130 F6000
N80 $ENDFOR
N90 M30
"""
    path = tmp_path / "flow.nc"
    path.write_text(program, encoding="utf-8")
    trace = run_own(path, PLANS / "rigs" / "probe-z.toml").facts.blocks
    assert trace is not None
    rows = trace.rows()
    lines = [trace.lines[place] for place in rows.line]
    # N70 of the second turn has no way: Z is at 130 already, nothing is carried out
    assert [line.number for line in lines] == [100, 70, 30, 100, 70, 90]
    written = program.splitlines()
    assert all(written[line.line - 1] == line.text for line in lines)
    assert rows.path_mm[[0, 1, 3, 4]].tolist() == pytest.approx([1.0] * 4)
    assert rows.end_ns[2] - rows.begin_ns[2] == 10_000_000
