"""Every command acts on a rig of another carrier than CAN, or refuses it by name."""

from collections.abc import Callable
from pathlib import Path

import pytest
import typer

from axisrig.bench.cli.main import app
from axisrig.bench.rig.reading.carriers import on_carriers

KNOW_NO_CARRIER = frozenset(
    (
        *("metrics", "oracles", "drives", "objects", "params", "errors", "explain"),
        *(
            "language",
            "doctor",
            "docs",
            "fmu",
            "plan",
            "probe-feed",
            "distance",
            "sources",
            "demo",
        ),
        *("merge", "diff", "trend"),
    )
)
"""They list tables, compute from numbers, make files, or take what a run has left, whatever carried
it; demo runs what it brings along."""


def commands() -> set[str]:
    """Names of all commands of `axisrig`, groups included."""
    group = typer.main.get_command(app)
    found: set[str] = set(group.commands)  # type: ignore[attr-defined]
    return found


def test_every_command_is_in_the_table_or_knows_no_carrier() -> None:
    in_table = {row.command.split()[0] for row in on_carriers()}
    assert commands() - in_table == KNOW_NO_CARRIER
    assert not KNOW_NO_CARRIER & in_table


PROGRAM = """%part
N10 G90 G01 Z101 F6000
N20 G100 Z98 F600
N30 #MSG SYN["z=%f", V.A.MEAS.ACS.VALUE.Z]
N40 M30
"""
PLAN = """case,program,rig,plant:z.position_start_mm,check:latch_error_um,check:alarms
row,part.nc,{rig},101,-0.0400 +- 0.0095,none
"""


@pytest.mark.long
def test_each_command_acts_on_ethercat(
    place: Path, axisrig: Callable[..., tuple[int, str, str]]
) -> None:
    """One row, and everything that takes its plan, its rig or what it has left."""
    rigs = Path(__file__).parents[2] / "testplans" / "rigs"
    rig, tuned = rigs / "probe-z-ethercat.toml", rigs / "distance-z-ethercat.toml"
    (place / "part.nc").write_text(PROGRAM, encoding="utf-8")
    (place / "plan.csv").write_text(PLAN.format(rig=rig), encoding="utf-8")

    def acts(words: str, *more: str) -> str:
        code, out, err = axisrig(*words.split(), *more)
        assert code == 0, f"{words}: {err}"
        return out

    acts("run plan.csv -o out -j 1")
    acts(f"check {rig}")
    acts("check plan.csv")
    acts("judge out --plan plan.csv")
    acts("replay out plan-row")
    acts("report out")
    acts("export out --csv")
    assert "plan-row" in acts("query out", "select run from cases")
    acts("budget plan.csv -k row -j 1")
    acts("perf --plan plan.csv --case row --repeats 1")
    acts(f"nc part.nc --rig {rig} --set plant:z.position_start_mm=101 --bus-log a.blf")
    assert "SAFEOP" in acts(f"bus a@ec1.pcapng --rig {rig}")
    acts(f"tune distance --rig {tuned}")
    acts(f"rig export {rig} -o own.ssp")
    acts("new mine --carrier ethercat")


SEARCH = """case,program,rig,search:plant:probe.surface_mm,check:msg:N30,check:search_good
row,part.nc,{rig},97.5 .. 99 to 0.5,== 1,98 .. 98.5
"""


@pytest.mark.long
def test_a_search_on_ethercat_ends_where_the_program_ends(
    place: Path, axisrig: Callable[..., tuple[int, str, str]]
) -> None:
    """The run goes to Z 98: a surface below it is not met."""
    rig = Path(__file__).parents[2] / "testplans" / "rigs" / "probe-z-ethercat.toml"
    program = PROGRAM.replace("#MSG SYN[\"z=%f\", V.A.MEAS.ACS.VALUE.Z]",
                              "#MSG SYN[\"m=%d\", V.A.MERF.Z]")  # fmt: skip
    (place / "part.nc").write_text(program, encoding="utf-8")
    (place / "plan.csv").write_text(SEARCH.format(rig=rig), encoding="utf-8")
    code, out, err = axisrig("run", "plan.csv", "-o", "out", "-j", "1")
    assert code == 0, out + err


@pytest.mark.long
def test_scenarios_have_machines_on_ethercat(
    axisrig: Callable[..., tuple[int, str, str]], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(Path(__file__).parents[2])
    code, out, err = axisrig("scenarios", "--machine", "ethercat-probe", "--count", "1", "-j", "1")
    assert code == 0, err
    assert out.startswith("1 scenario\n")
