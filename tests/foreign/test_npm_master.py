"""A master that nobody here wrote leads our drive: the npm package `canopen`, over a pipe.

`npm/master.js` reads the EDS, configures the drive by SDO, maps its PDOs, moves the axis, measures,
brings the drive into fault and out again. What it reports is compared with the standard's numbers
and with what the plant knows. Bus time stands still while the script thinks.
"""

import json
import subprocess
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from tests.can_parts import can_of

from axisrig.bench.drive.cia402.dictionary.eds import eds_text
from axisrig.bench.machine.machine import Machine
from axisrig.bench.rig.reading.file import read_rig
from axisrig.bench.rig.settings import read_settings
from axisrig.kernel.nc.text.parser import read_program
from axisrig.kernel.time.clock import MS

HERE = Path(__file__).parent
RIG = HERE.parents[1] / "testplans" / "rigs" / "probe-z.toml"
NODE_ID = 3
INCREMENTS_PER_MM = 2**20 / 10  # 20 bit per revolution, 10 mm lead
SURFACE_MM, START_MM, STEP_MM = 100.0, 130.0, 0.02  # probe-z.toml; 20 mm/s at 1 ms
INPUT_DELAY_S = 4e-6
LIMIT_MS = 60_000

Report = dict[str, Any]


class Pipe:
    """The script with its port on the segment of a rig."""

    def __init__(self, node_js: str, folder: Path) -> None:
        rig, files = read_rig(RIG)
        program = folder / "empty.nc"
        program.write_text("%empty\nM30\n", encoding="ascii")
        self.machine = Machine(read_settings(rig, files, []), read_program(program, ("Z",)))
        self._port = can_of(self.machine).segments["can1"].port("foreign master")
        self._heard: list[tuple[int, str]] = []
        self._port.attach(lambda m: self._heard.append((m.arbitration_id, bytes(m.data).hex())))
        eds = folder / "drive.eds"
        eds.write_text(eds_text(can_of(self.machine).nodes["Z"].profile), encoding="ascii")
        plan = {
            "target": round((SURFACE_MM - 5) * INCREMENTS_PER_MM),
            "home": round((SURFACE_MM + 5) * INCREMENTS_PER_MM),
            "step": round(STEP_MM * INCREMENTS_PER_MM),
            "latch_object": 0x60BA,
        }
        script = str(HERE / "npm" / "master.js")
        self._process = subprocess.Popen(
            [node_js, script, str(eds), str(NODE_ID), json.dumps(plan)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )

    def _ask(self, time_ms: int) -> Report:
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        heard, self._heard[:] = list(self._heard), []
        self._process.stdin.write(json.dumps({"time_ms": time_ms, "frames": heard}) + "\n")
        self._process.stdin.flush()
        line = self._process.stdout.readline()
        assert line, f"the script ended with {self._process.wait()}"
        answer: Report = json.loads(line)
        for can_id, data in answer["frames"]:
            self._port.send_raw(can_id, bytes.fromhex(data))
        return answer

    def run(self) -> Report:
        """Let the script do its work; simulated time goes on by 1 ms per answer."""
        for time_ms in range(LIMIT_MS):
            answer = self._ask(time_ms)
            if "report" in answer:
                assert answer["ended"] == "done", (answer["ended"], answer["report"])
                report: Report = answer["report"]
                return report
            self.machine.scheduler.run_until((time_ms + 1) * MS)
        raise AssertionError("the script did not end")

    def close(self) -> None:
        self._process.kill()
        self._process.communicate()
        self.machine.close()


@pytest.fixture(scope="module")
def visit(
    node_js: str, tmp_path_factory: pytest.TempPathFactory
) -> Callable[[], tuple[Report, list[tuple[int, bool]]]]:
    """What one run of the script reports, and the edges of the probe in the plant."""

    @cache
    def run() -> tuple[Report, list[tuple[int, bool]]]:
        pipe = Pipe(node_js, tmp_path_factory.mktemp("npm"))
        try:
            report = pipe.run()
            (probe,) = pipe.machine.plant.probes.values()
            return report, list(probe.signal.edges)
        finally:
            pipe.close()

    return run


def test_it_reads_our_electronic_data_sheet(visit: Any) -> None:
    report, _ = visit()
    assert report["edsVendor"] == "axisrig"
    assert report["edsObjects"] > 50


def test_it_goes_through_every_step(visit: Any) -> None:
    report, _ = visit()
    enabled = ["ready to switch on", "switched on", "operation enabled"]
    before = ["identified", "configured", *enabled, "measured"]
    assert report["steps"] == [*before, *enabled, "fault reset", "ready to switch on", "stopped"]


def test_it_reads_objects_by_expedited_segmented_and_block_transfer(visit: Any) -> None:
    read = visit()[0]["read"]
    assert read["deviceType"] == 0x0002_0192  # servo drive of profile 402
    assert read["identity"] == 4
    assert read["modes"] & 1 << 7  # cyclic synchronous position
    assert read["name"] == read["nameByBlock"] != ""
    assert read["window"] == 4_000_000_000
    assert read["windowByBlock"] == 3_000_000_000


def test_it_asks_for_the_identity_by_layer_setting_services(visit: Any) -> None:
    report, _ = visit()
    assert report["identity"] == report["read"]["identities"]
    assert len(report["identity"]) == 4


def test_what_it_must_not_do_is_refused_with_the_standard_code(visit: Any) -> None:
    aborts = {name: int(code) for name, code in visit()[0]["aborts"].items()}
    assert aborts == {
        "unknown object": 0x0602_0000,
        "unknown sub-index": 0x0609_0011,
        "write to read only": 0x0601_0002,
        "too long": 0x0607_0012,  # length too high
    }


def test_it_follows_the_state_of_the_node_by_heartbeats(visit: Any) -> None:
    heartbeats = visit()[0]["heartbeats"]
    assert heartbeats == [0, 127, 5, 4]  # boot-up, pre-operational, operational, stopped


def test_it_latches_the_surface(visit: Any) -> None:
    """v is the demand's; the drive follows it with a constant lag, so the motor has it too."""
    report, edges = visit()
    (_, level), *_ = edges
    assert level
    speed_mm_s = STEP_MM / 1e-3
    expected_mm = SURFACE_MM - speed_mm_s * INPUT_DELAY_S
    assert report["latched"] / INCREMENTS_PER_MM == pytest.approx(
        expected_mm, abs=1 / INCREMENTS_PER_MM
    )
    assert report["latchedAfterwards"] == report["latched"]  # kept through the falling edge


def test_it_brings_the_drive_into_fault_and_out_again(visit: Any) -> None:
    report, _ = visit()
    # following error; generic and profile-specific bit; then no error
    assert report["emergencies"] == [[0x8611, 0x21], [0, 0]]
    assert report["errorRegister"] == 0x21
    assert report["faultStatus"] & 0x4F == 0x08
    assert report["faultStatus"] & 1 << 13
