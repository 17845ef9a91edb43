"""What the command line tells about the bus: overload on demand, load and waits, speed."""

import csv
from collections.abc import Callable
from pathlib import Path

import can
import pytest
from tests.reports.pages import whole

from axisrig.bench.bus.can.frame import Frame, frame_bits
from axisrig.bench.record.facts import Facts, read_run

Call = Callable[..., tuple[int, str, str]]
SLOW = ("--set", "bus:can1.bitrate=500000")
METRICS = (
    "bus_load_pct", "bus_load_100ms_pct_max", "bus_load_1ms_pct_max", "error_frames",
    "queueing_us_max", "queueing_us_max:Z",
)  # fmt: skip


@pytest.fixture
def plan(place: Path) -> Path:
    path = place / "plan.csv"
    checks = ",".join(f"check:{name}" for name in METRICS)
    cells = ",".join([">= 0"] * len(METRICS))
    path.write_text(
        f"case,program,rig,plc:V.E.FEED,{checks}\na,part.nc,rig.toml,3000,{cells}\n",
        encoding="utf-8",
    )
    return path


def stored(place: Path) -> tuple[dict[str, float], Facts]:
    with (place / "out" / "results.csv").open(newline="", encoding="utf-8") as file:
        values = {
            row["metric"]: float(row["value"]) for row in csv.DictReader(file) if row["value"]
        }
    facts = read_run(place / "out" / "runs" / "plan-a.json").facts
    assert facts is not None
    return values, facts


@pytest.mark.long
def test_load_and_waits_fit_the_log(place: Path, axisrig: Call, plan: Path) -> None:
    """The log has the end of every frame; with its length the busy time follows."""
    assert axisrig("run", plan, "-o", "out")[0] == 0
    values, facts = stored(place)
    with can.BLFReader(place / "out" / "bus" / "plan-a.blf") as reader:
        log = [
            (
                round(msg.timestamp * 1e9),
                frame_bits(
                    Frame(msg.arbitration_id, bytes(msg.data), False, msg.is_remote_frame, msg.dlc)
                ),
            )
            for msg in reader
        ]
    with (place / "out" / "cases.csv").open(newline="", encoding="utf-8") as file:
        (case,) = csv.DictReader(file)
    total_us = float(case["sim_s"]) * 1e6
    assert values["bus_load_pct"] == pytest.approx(
        100 * sum(b for _, b in log) / total_us, rel=1e-3
    )
    by_ms = [0.0] * (round(total_us / 1e3) + 1)
    for end_ns, bits in log:
        free_us = end_ns / 1e3 + 3
        for ms in {int((free_us - bits) // 1e3), int(free_us // 1e3)}:
            by_ms[ms] += min(free_us, (ms + 1) * 1e3) - max(free_us - bits, ms * 1e3)
    worst_us = max(sum(by_ms[first : first + 100]) for first in range(len(by_ms)))
    assert values["bus_load_100ms_pct_max"] == pytest.approx(worst_us / 1e3, rel=1e-3)
    assert values["error_frames"] == 0
    (bus,) = facts.buses
    waits = {wait.name: wait.worst_us for wait in bus.waiting}
    assert {"SYNC", "Z.TPDO1", "Z.RPDO1", "Z.SDO request"} <= set(waits)
    assert values["queueing_us_max"] == max(waits.values())
    assert values["queueing_us_max:Z"] == max(us for name, us in waits.items() if "Z." in name)
    report = whole(place / "out" / "report.html")
    assert "<caption>Bus</caption>" in report
    assert "Z.TPDO1" in report


@pytest.mark.long
def test_overload_runs_only_when_forced_and_is_told(place: Path, axisrig: Call, plan: Path) -> None:
    code, out, err = axisrig("run", plan, "-o", "out", *SLOW)
    assert (code, out) == (2, "")
    assert "does not fit on segment can1" in err
    assert "--force" in err
    _, out, _ = axisrig("run", plan, "-o", "out", *SLOW, "--force")
    line = next(line for line in out.splitlines() if "overloaded" in line)
    assert "segment can1 is overloaded: last TPDO" in line
    _, facts = stored(place)
    (bus,) = facts.buses
    assert bus.overload
    assert "overloaded:" in whole(place / "out" / "report.html")
    _, out, _ = axisrig("replay", "out", "plan-a")
    assert out.splitlines()[-1] == "frame_log_sha256 equal"


@pytest.mark.long
def test_an_overload_is_told_once_when_a_check_fails_too(
    place: Path, axisrig: Call, plan: Path
) -> None:
    plan.write_text(plan.read_text(encoding="utf-8").replace(">= 0", "< 0"), encoding="utf-8")
    _, out, _ = axisrig("run", plan, "-o", "out", *SLOW, "--force")
    assert out.count("is overloaded: ") == 1


@pytest.mark.long
def test_nc_and_check_take_force_too(place: Path, axisrig: Call) -> None:
    text = (place / "rig.toml").read_text(encoding="utf-8")
    (place / "rig.toml").write_text(text.replace("1_000_000\n\n[drive", "500_000\n\n[drive"))
    words = ("nc", "part.nc", "--rig", "rig.toml", "--set", "plc:V.E.FEED=3000")
    assert axisrig(*words)[0] == 2
    assert "segment can1 is overloaded" in axisrig(*words, "--force")[2]
    assert axisrig("check", "rig.toml")[0] == 2
    code, out, _ = axisrig("check", "rig.toml", "--force")
    assert code == 0
    assert "over" in out


@pytest.mark.long
def test_run_writes_the_kinds_of_logs_that_are_asked_for(
    place: Path, axisrig: Call, plan: Path
) -> None:
    assert axisrig("run", plan, "-o", "out", "--bus-log", "blf,candump,asc,pcap")[0] == 0
    names = {path.name for path in (place / "out" / "bus").iterdir()}
    assert names == {f"plan-a.{suffix}" for suffix in ("blf", "log", "asc", "pcap")}
    code, _, err = axisrig("run", plan, "-o", "out", "--bus-log", "mf4")
    assert code == 2
    assert "blf, candump, asc, pcap" in err


@pytest.mark.long
def test_a_log_is_told_in_words(place: Path, axisrig: Call, plan: Path) -> None:
    assert axisrig("run", plan, "-o", "out", "--bus-log", "blf,candump")[0] == 0
    code, out, err = axisrig("bus", "out", "plan-a")
    assert (code, err) == (0, "")
    lines = out.splitlines()
    assert "reset communication, node 3" in lines[0]
    assert any("Z.heartbeat" in line and "boot-up" in line for line in lines)
    assert any(line.endswith("Device type = 131474 (0x00020192)") for line in lines)
    states = [line.partition("(")[2].partition(")")[0] for line in lines if "Statusword 0x" in line]
    climbed = ["switch on disabled", "ready to switch on", "switched on", "operation enabled"]
    assert [state for state in dict.fromkeys(states) if state in climbed] == climbed
    # The same from the file, by the names of its rig; without a rig by numbers
    _, message, _ = axisrig("bus", "out/bus/plan-a.log", "--rig", "rig.toml", "--only", "SDO")
    assert message
    assert all(" Z.SDO " in line for line in message.splitlines())
    _, bare, _ = axisrig("bus", "out/bus/plan-a.blf", "--from", "1", "--to", "2")
    assert "3.SDO request" in bare
    assert all(1.0 <= float(line.split()[0]) <= 2.0 for line in bare.splitlines())
    everything = axisrig("bus", "out", "plan-a", "--all")[1].splitlines()
    with can.BLFReader(place / "out" / "bus" / "plan-a.blf") as reader:
        assert len(everything) == len(list(reader))


@pytest.mark.parametrize(
    ("words", "message"),
    [(("out",), "plan-a"), (("plan.csv",), ".blf"), (("nowhere.blf",), ".blf")],
)
def test_a_log_that_is_none_is_refused(
    place: Path, axisrig: Call, plan: Path, words: tuple[str, ...], message: str
) -> None:
    if words == ("out",):
        axisrig("run", plan, "-o", "out")
    code, out, err = axisrig("bus", *words)
    assert (code, out) == (2, "")
    assert message in err
