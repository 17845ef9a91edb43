"""A program with a subprogram, loops, own variables and a value for the PLC side, on a rig."""

from pathlib import Path

import pytest

from axisrig.bench.campaign.single import run_program

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


def test_the_plc_side_has_the_mean_afterwards(mean: tuple[list[str], list[str]]) -> None:
    _, said = mean
    (line,) = [text for text in said if "V.E.MEAN" in text]
    value_mm = float(line.split("V.E.MEAN = ")[1].split()[0])
    assert value_mm == pytest.approx(100.0, abs=1e-4)
    assert "block N190" in line


def test_a_word_that_does_not_act_ends_the_program_when_the_machine_gets_there(
    tmp_path: Path,
) -> None:
    program = tmp_path / "later.nc"
    program.write_text(
        'G1 G90 Z110 F3000\n#MSG SYN ["there %f", V.A.ABS.Z]\n#TRAFO ON\nZ50\n', encoding="utf-8"
    )
    texts, said = run(program)
    assert texts == ["there 110.000000"]
    assert "ID 900100" in said[-1]
