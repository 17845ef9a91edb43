"""The command line as its caller meets it: exit codes, the two outputs, help."""

import json
from collections.abc import Callable
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

import pandas as pd
import pytest
from cli_plan import write_plan

from axisrig.bench.campaign import runner
from axisrig.bench.campaign.results.build_info import build_word, sources_sha256
from axisrig.bench.plan.case import Case
from axisrig.fmus import MODELS

Outcome = tuple[int, str, str]
Call = Callable[..., Outcome]
Reject = Callable[..., str]

ROOT = Path(__file__).parents[2]
COMMANDS = [
    ["run"], ["demo"], ["nc"], ["check"], ["replay"], ["report"], ["metrics"], ["perf"], ["bus"],
    ["params"],
    ["doctor"], ["fmu"], ["fmu", "list"], ["fmu", "show"], ["fmu", "check"], ["fmu", "build"],
]  # fmt: skip


# ---- help and usage


@pytest.mark.parametrize("words", COMMANDS, ids=" ".join)
@pytest.mark.parametrize("width", [80, 120])
def test_help_of_every_command_fits_the_terminal(
    axisrig: Call, monkeypatch: pytest.MonkeyPatch, words: list[str], width: int
) -> None:
    monkeypatch.setenv("COLUMNS", str(width))
    code, out, err = axisrig(*words, "--help")
    assert (code, err) == (0, "")
    assert "Usage:" in out
    assert max(map(len, out.splitlines())) <= width


def test_help_of_the_whole_names_every_command(axisrig: Call) -> None:
    code, out, err = axisrig("--help")
    assert (code, err) == (0, "")
    for words in COMMANDS:
        assert f" {words[0]} " in out


def test_the_page_of_commands_names_every_command() -> None:
    text = (ROOT / "docs" / "commands.md").read_text(encoding="utf-8")
    for words in COMMANDS:
        if words != ["fmu"]:
            assert f"axisrig {' '.join(words)}" in text, words


@pytest.mark.parametrize(
    "words",
    [
        ["fly"],
        ["run"],
        ["run", "plan.csv", "--fast"],
        ["run", "plan.csv", "-j", "0"],
        ["run", "plan.csv", "-j", "two"],
        ["run", "plan.csv", "--timeout", "0"],
        ["nc", "--rig", "rig.toml"],
        ["check"],
        ["replay", "out"],
        ["perf", "--repeats", "0"],
        ["metrics", "all"],
        ["fmu", "burn"],
    ],
    ids=" ".join,
)
def test_wrong_usage_goes_to_standard_error(axisrig: Call, words: list[str]) -> None:
    code, out, err = axisrig(*words)
    assert (code, out) == (2, "")
    assert "Usage:" in err
    assert "--help" in err


def test_a_program_without_a_rig_is_told_what_it_lacks(axisrig: Call) -> None:
    code, out, err = axisrig("nc", "part.nc")
    assert (code, out) == (2, "")
    assert "--rig FILE" in err
    assert "--check" in err


# ---- what goes where


@pytest.mark.long
def test_nc_prints_the_messages_only(place: Path, axisrig: Call) -> None:
    words = ("nc", "part.nc", "--rig", "rig.toml", "--set", "plc:V.E.FEED=3000")
    assert axisrig(*words) == (0, "V.A.MERF.Z=1\n", "")
    # without the workpiece the run ends at its target, which measuring type 1 allows
    away = axisrig(*words, "--set", "plant:probe.surface_mm=0")
    assert away == (0, "V.A.MERF.Z=0\n", "")


def test_nc_puts_an_alarm_on_standard_error_with_its_id(place: Path, axisrig: Call) -> None:
    words = ("nc", "part.nc", "--rig", "rig.toml", "--set", "plc:V.E.FEED=3000")
    code, out, err = axisrig(*words, "--set", "set:Z.kenngr.messachse=0")
    assert (code, out) == (1, "")
    assert err.startswith("ID 50059 class 4: ")
    assert "line 2, block N20" in err
    assert len(err.splitlines()) == 1


@pytest.mark.long
def test_nc_tells_stops_and_functions_with_their_instants(place: Path, axisrig: Call) -> None:
    """The drives are on after 24 ms; the axis stands for 10 cycles before M0 counts."""
    (place / "part.nc").write_text(
        'N10 M8\nN20 G4 0.1\nN30 M0\nN40 #MSG SYN ["on"]\nN50 M30\n', encoding="utf-8"
    )
    words = ("nc", "part.nc", "--rig", "rig.toml")
    code, out, err = axisrig(*words, "--set", "plc:start_ms=250")
    assert (code, out) == (0, "on\n")
    found = [line.partition(" s: ") for line in err.splitlines()]
    instants = [round(1000 * float(at)) for at, _, _ in found]
    assert [at - instants[0] for at in instants] == [0, 110, 360]
    assert [text for _, _, text in found] == [
        "M8 to the PLC (part.nc line 1, block N10)",
        "M0: stop (part.nc line 3, block N30)",
        "M0: started again (part.nc line 3, block N30)",
    ]
    code, out, err = axisrig(*words)
    assert (code, out) == (1, "")
    assert "ID 900170 class 2: M0 " in err


def test_nc_keeps_the_messages_before_an_alarm(place: Path, axisrig: Call) -> None:
    (place / "part.nc").write_text(
        'N10 G1 Z131 F3000\nN20 #MSG ["here"]\nN30 G101 Z1\nN40 M30\n', encoding="utf-8"
    )
    code, out, err = axisrig("nc", "part.nc", "--rig", "rig.toml")
    assert (code, out) == (1, "here\n")
    assert err.startswith("ID 900101 ")


@pytest.mark.parametrize("option", ["part.nc", "rig.toml", "notes.txt"])
def test_bus_log_does_not_write_over_anything_else(place: Path, axisrig: Call, option: str) -> None:
    (place / "notes.txt").write_text("mine", encoding="utf-8")
    before = (place / option).read_bytes()
    words = ("nc", "part.nc", "--rig", "rig.toml", "--set", "plc:V.E.FEED=3000")
    code, out, err = axisrig(*words, "--bus-log", option)
    assert (code, out) == (2, "")
    assert ".blf" in err
    assert (place / option).read_bytes() == before


ROWS = {
    "pass": ("a,part.nc,rig.toml,3000,== 1,", 0),
    "fail": ("a,part.nc,rig.toml,3000,== 0,", 1),
    "expected alarm": ("a,part.nc,rig.toml,-5,,== 20008", 0),
    "alarm that nobody expects": ("a,part.nc,rig.toml,-5,,", 1),
}


@pytest.mark.parametrize(("row", "expected"), ROWS.values(), ids=ROWS)
@pytest.mark.long
def test_run_ends_with_the_code_of_the_worst_verdict(
    place: Path, axisrig: Call, row: str, expected: int
) -> None:
    good = "good,part.nc,rig.toml,3000,== 1,"
    code, out, err = axisrig("run", write_plan(place, row, good), "-o", "out")
    assert code == expected, err
    assert out.splitlines()[-1] == "out/report.html"
    assert "plan-good" in err  # progress
    cases = pd.read_csv(place / "out" / "cases.csv")
    assert list(cases["case"]) == ["a", "good"]
    assert list(cases["verdict"]) == ["pass" if expected == 0 else "fail", "pass"]


@pytest.mark.long
def test_defect_in_one_row_costs_that_row_only(
    place: Path, axisrig: Call, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What no user can cause is verdict error of the row, code 4, and the rest runs on."""
    run_case = runner._run_case

    def breaks(case: Case, *rest: Any) -> Any:
        if case.case == "a":
            raise RuntimeError("a wheel came off")
        return run_case(case, *rest)

    monkeypatch.setattr(runner, "_run_case", breaks)
    rows = [f"{name},part.nc,rig.toml,3000,== 1," for name in ("a", "b")]
    code, out, err = axisrig("run", write_plan(place, *rows), "-o", "out")
    assert code == 4
    assert "a wheel came off" in out
    assert "Traceback" not in err
    cases = pd.read_csv(place / "out" / "cases.csv")
    assert list(cases["verdict"]) == ["error", "pass"]
    found = json.loads((place / "out" / "runs" / "plan-a.json").read_text(encoding="utf-8"))
    assert "a wheel came off" in found["error"]


def test_check_describes_plan_and_rig_on_standard_output(place: Path, axisrig: Call) -> None:
    plan = write_plan(place, "a,part.nc,rig.toml,3000,== 1,")
    code, out, err = axisrig("check", plan, "rig.toml")
    assert (code, err) == (0, "")
    assert "plan.csv: 1 run" in out
    assert "plan-a" in out
    # SYNC 55, RPDO1 and TPDO1 135 each, the latch TPDO with its counter 115 us
    assert "440.0 of 1000.0 us" in out
    assert not (place / "out").exists()


@pytest.mark.long
def test_check_goes_on_after_a_file_that_is_rejected(place: Path, axisrig: Call) -> None:
    plan = write_plan(place, "a,part.nc,rig.toml,3000,== 1,")
    (place / "bad.csv").write_text("case,progam\na,part.nc\n", encoding="utf-8")
    (place / "bad.lst").write_text("kenngr.messachse maybe\n", encoding="utf-8")
    code, out, err = axisrig("check", "bad.csv", plan, "gone.toml", "rig.toml", "bad.lst")
    assert code == 2
    assert "plan-a" in out
    assert "of 1000.0 us" in out
    for name in ("bad.csv", "gone.toml", "bad.lst"):
        assert f"error: {name}" in err or f"/{name}" in err
    assert axisrig("check", plan, "bad.csv")[0] == 2
    assert axisrig("check", plan, "rig.toml")[0] == 0


@pytest.mark.parametrize(
    "width",
    [80, 120],
)
@pytest.mark.long
def test_tables_fit_the_terminal(
    place: Path, axisrig: Call, monkeypatch: pytest.MonkeyPatch, width: int
) -> None:
    monkeypatch.setenv("COLUMNS", str(width))
    plan = write_plan(place, "a,part.nc,rig.toml,3000,== 0,")
    for words in (["metrics"], ["check", "rig.toml"], ["run", plan, "-o", "out"]):
        _, out, _ = axisrig(*words)
        table = [line for line in out.splitlines() if not line.startswith("plan-a: ")]
        assert max(map(len, table)) <= width, words


@pytest.mark.long
def test_small_commands(axisrig: Call) -> None:
    code, out, err = axisrig("metrics")
    assert (code, err) == (0, "")
    assert "latch_error_um" in out
    code, out, err = axisrig("fmu", "list")
    assert (code, err) == (0, "")
    assert set(out.split()) >= {"AxisRig.Drives.ServoAxis", "AxisRig.Sensors.TouchProbe"}
    code, out, err = axisrig("fmu", "build")
    assert (code, err) == (0, "")
    assert out.count(".fmu\n") == len(MODELS)
    code, out, err = axisrig("doctor", "--build")
    assert (code, err) == (0, "")
    assert "LACKS" not in out
    assert "pip install -e" not in out  # a wheel has no source folder
    assert "rumoca 0.10.2" in out
    assert f"info  axisrig runs {build_word()}, sources {sources_sha256()}\n" in out


@pytest.mark.long
def test_replay_tells_whether_every_frame_came_again(place: Path, axisrig: Call) -> None:
    plan = write_plan(place, "a,part.nc,rig.toml,3000,== 1,")
    assert axisrig("run", plan, "-o", "out", "--set", "plant:z.kv=30")[0] == 0
    code, out, _ = axisrig("replay", "out", "plan-a")
    assert code == 0
    assert out.splitlines()[-1] == "frame_log_sha256 equal"
    # another rig below the same plan gives other frames, which is no pass
    text = (place / "rig.toml").read_text(encoding="utf-8")
    (place / "rig.toml").write_text(text.replace("= 130", "= 131"), encoding="utf-8")
    code, out, _ = axisrig("replay", "out", "plan-a")
    assert code == 1
    assert "DIFFERS" in out.splitlines()[-1]


# ---- perf


@pytest.mark.long
def test_perf_json_is_one_object_with_the_split_and_the_hash_of_run(
    place: Path, axisrig: Call
) -> None:
    plan = write_plan(place, "slow,part.nc,rig.toml,1000,== 1,", "a,part.nc,rig.toml,3000,== 1,")
    code, out, err = axisrig("perf", "--json", "--plan", plan, "--case", "a", "--repeats", "1")
    assert (code, err) == (0, "")
    found = json.loads(out)
    assert found["case"] == "plan-a"
    assert found["real_time_factor"] == pytest.approx(found["simulated_s"] / found["wall_s"])
    split = found["cycle_us"]
    parts = {"kernel", "bus", "codec", "fmu", "recording"}
    assert set(split) == {"rest"} | (set() if found["compiled"] else parts)
    assert all(isinstance(spent, float) and spent >= 0 for spent in split.values())
    assert axisrig("run", plan, "-o", "out", "-k", "a")[0] == 0
    cases = pd.read_csv(place / "out" / "cases.csv")
    assert found["frame_log_sha256"] == cases["frame_log_sha256"][0]
    assert found["simulated_s"] == cases["sim_s"][0]


@pytest.mark.long
def test_perf_takes_the_first_row_and_prints_a_table(place: Path, axisrig: Call) -> None:
    plan = write_plan(place, "a,part.nc,rig.toml,3000,== 1,")
    code, out, err = axisrig("perf", "--plan", plan, "--repeats", "1")
    assert (code, err) == (0, "")
    assert out.startswith("plan-a: ")
    assert "real time factor" in out
    code, out, err = axisrig("perf", "--plan", plan, "--case", "b")
    assert (code, out) == (2, "")
    assert "allowed: a" in err


# ---- version, variables, probes


def test_the_version_is_that_of_the_package(axisrig: Call) -> None:
    code, out, _ = axisrig("--version")
    assert code == 0
    try:
        assert out == f"axisrig {version('axisrig')}\n"
    except PackageNotFoundError:
        assert "without being installed" in out


def test_a_program_without_its_external_variable_is_told_how_to_give_it(rejected: Reject) -> None:
    message = rejected("nc", "part.nc", "--rig", "rig.toml")
    assert "--set plc:V.E.FEED=<value>" in message


def test_check_lists_the_axes_and_warns_of_a_probe_that_nobody_reads(
    place: Path, axisrig: Call
) -> None:
    code, out, _ = axisrig("check", "rig.toml")
    wired = "drive servo (profile generic), plant z, probe_1 = probe"
    assert code == 0
    assert f"axis Z: node 3 on can1, {wired}" in out
    assert "warning" not in out
    rig = place / "rig.toml"
    text = rig.read_text(encoding="utf-8").replace('probe_1 = "probe"\n', "")
    rig.write_text(text, encoding="utf-8")
    _, out, _ = axisrig("check", "rig.toml")
    assert "no probe wired" in out
    assert "warning: probe is wired to no input of a drive" in out
