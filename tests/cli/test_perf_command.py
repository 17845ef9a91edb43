"""`axisrig perf`: a row, the suite, and both beside an earlier measurement."""

import json
from collections.abc import Callable
from pathlib import Path

import pytest
from cli_plan import write_plan

from axisrig.bench.campaign.results.build_info import is_compiled, sources_sha256
from axisrig.bench.cli.perf_command import cpu_ns
from axisrig.bench.tools.perf.stages import REST, SIMULATION, STAGES

Call = Callable[..., tuple[int, str, str]]
ROW = "a,part.nc,rig.toml,3000,== 1,"


@pytest.mark.long
def test_a_row_says_what_ran_and_what_it_cost(place: Path, axisrig: Call) -> None:
    plan = write_plan(place, ROW)
    code, out, err = axisrig("perf", "--json", "--plan", plan, "--repeats", "2")
    assert (code, err) == (0, "")
    found = json.loads(out)
    assert found["compiled"] is is_compiled()
    assert found["sources_sha256"] == sources_sha256()
    assert found["cpu_factor"] == pytest.approx(found["simulated_s"] / found["cpu_s"])
    assert 0 < found["beyond_simulation_ms"] < 1e3 * found["cpu_s"] + 1e3


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--stages", "--profile"], "--profile and --stages measure different things"),
        (["--stages", "--against", "b.json"], "--stages has no earlier numbers to compare with"),
    ],
)
def test_one_thing_is_measured(options: list[str], message: str, axisrig: Call) -> None:
    code, out, err = axisrig("perf", *options)
    assert (code, out) == (2, "")
    assert message in err


@pytest.mark.long
def test_a_row_beside_an_earlier_one(place: Path, axisrig: Call) -> None:
    plan = write_plan(place, ROW)
    words = ("perf", "--plan", plan, "--repeats", "1")
    first = json.loads(axisrig(*words, "--json")[1])
    Path("before.json").write_text(json.dumps(first), encoding="utf-8")
    code, out, _ = axisrig(*words, "--against", "before.json")
    assert code == 0
    assert "against the file (above 1: better than it)\n  real_time_factor" in out
    assert "frames differ" not in out
    found = json.loads(axisrig(*words, "--json", "--against", "before.json")[1])
    gain = found["real_time_factor"] / first["real_time_factor"]
    assert found["gains"]["real_time_factor"] == pytest.approx(gain)
    assert "frames differ: plan-a" in against_other_frames(axisrig, words, first)


def against_other_frames(axisrig: Call, words: tuple[object, ...], first: dict[str, object]) -> str:
    Path("other.json").write_text(json.dumps(first | {"frame_log_sha256": "0"}), encoding="utf-8")
    return axisrig(*words, "--against", "other.json")[1]


def test_what_is_no_earlier_row_is_refused(place: Path, rejected: Callable[..., str]) -> None:
    plan = write_plan(place, ROW)
    words = ("perf", "--plan", plan, "--against")
    assert "no result of axisrig perf" in rejected(*words, place / "none")
    (place / "suite.json").write_text('{"suite": []}', encoding="utf-8")
    assert "no result of axisrig perf --json" in rejected(*words, place / "suite.json")


@pytest.mark.long
def test_the_profile_of_a_row(place: Path, axisrig: Call) -> None:
    plan = write_plan(place, ROW)
    code, out, err = axisrig("perf", "--plan", plan, "--profile")
    assert (code, err) == (0, "")
    assert out.startswith("plan-a: ")
    assert "own us   share   calls  function" in out


@pytest.mark.long
def test_the_stages_of_a_row(place: Path, axisrig: Call) -> None:
    """As words with the time of each, or as JSON with the same stages."""
    plan = write_plan(place, ROW)
    words = ("perf", "--plan", plan, "--stages", "--repeats", "1")
    code, out, err = axisrig(*words)
    assert (code, err) == (0, "")
    found = json.loads(axisrig(*words, "--json")[1])
    assert set(found["stages_ms"]) == {*STAGES, REST} - {SIMULATION}
    for name in found["stages_ms"]:
        assert f"| {name} | " in out


def test_cpu_time_goes_on() -> None:
    before_ns = cpu_ns()
    assert sum(range(100_000)) > 0
    assert cpu_ns() > before_ns
