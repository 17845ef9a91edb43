"""A campaign made of formulas: 14 runs of a probing move, every verdict among them."""

import csv
import json
import shutil
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pyarrow as pa
import pytest
from tests.recordings import Step, alarm, block_trace, facts, kept
from tests.reports.browsing import HOSTILE
from tests.tools.chromium import Browser

from axisrig.bench.campaign.results.manifest import build_manifest
from axisrig.bench.campaign.results.writer import (
    CaseResult,
    ResultsWriter,
    no_values,
)
from axisrig.bench.plan.case import Case
from axisrig.bench.plan.checks import CheckResult, judge
from axisrig.bench.plan.plan import read_plan
from axisrig.bench.plan.verdict import Verdict, worst
from axisrig.bench.record.axes import AxisRecord, Contact, Edge, Latch, ProbeRecord
from axisrig.bench.record.blocks import BlockTrace
from axisrig.bench.record.facts import Facts, MessageRecord, Note
from axisrig.bench.record.measuring import MeasurementRun
from axisrig.reports.build import build_report

FEEDS_MM_S = (1.0, 2.0, 5.0, 10.0, 16.7, 25.0, 50.0)
KV = 10.0
SURFACE_MM = 40.0
DECELERATION_MM_S2 = 1000.0
REST_S = 0.3

Array = npt.NDArray[np.float64]


def plan_text(cases: int) -> str:
    """A plan of probing runs with limits on latch error, lag, overtravel and a message."""
    head = (
        "case,program,rig,title,requirement,plant:probe.trigger_delay_us,set:Z.kenngr.measure.edge,"
        "check:latch_error_um:Z,check:latch_mm:Z,check:lag_mm_max:Z,check:overtravel_mm:Z,"
        "check:msg:N30,check:alarms"
    )
    rows = [head]
    for i in range(cases):
        feed = FEEDS_MM_S[i % len(FEEDS_MM_S)]
        alarms = "50052" if i == 9 else ""
        rows.append(
            f"feed_{feed:g}_{'a' if i < len(FEEDS_MM_S) else 'b'},probe.nc,machine.toml,"
            f'"Touch at {feed:g} mm/s, {"rising" if i % 2 else "falling"} edge",REQ-{12 + i // 4},'
            f"{3 + i},{'POS' if i % 2 else 'NEG'},"
            f"-0.2 .. 0.2,39.99 .. 40.01,<= {feed / KV + 0.05:.3f},<= 5,40 +- 0.01,{alarms}"
        )
    return "\n".join(rows) + "\n"


def probing_trace(feed: float, samples: int, noise: np.random.Generator) -> tuple[pa.Table, float]:
    """Z runs to SURFACE_MM with a lag of v/Kv and brakes there; the contact time in s too."""
    time_s = np.arange(samples, dtype=np.float64) * 0.001
    contact_s = min(REST_S + (SURFACE_MM / feed), 0.6 * time_s[-1])
    braking_s = contact_s + 0.0036
    start_mm = SURFACE_MM + feed * (contact_s - REST_S)

    def position(t: Array) -> Array:
        run = np.clip(np.minimum(t, braking_s) - REST_S, 0.0, None)
        ramp = np.clip(t - braking_s, 0.0, feed / DECELERATION_MM_S2)
        path = feed * run + feed * ramp - 0.5 * DECELERATION_MM_S2 * ramp**2
        back = 12.0 * np.clip(t - braking_s - 0.35, 0.0, 0.4)
        return np.asarray(start_mm - path + back, dtype=np.float64)

    set_mm = position(time_s)
    truth = np.empty(samples)
    truth[0] = set_mm[0]
    for i in range(1, samples):
        truth[i] = truth[i - 1] + 0.001 * KV * (set_mm[i - 1] - truth[i - 1])
    truth += 2e-5 * np.sin(2 * np.pi * 60 * time_s) * feed / 10
    actual = np.round((truth + noise.normal(0.0, 1e-5, samples)) / 1e-4) * 1e-4
    columns: dict[str, npt.NDArray[np.generic]] = {
        "time_ns": (np.arange(samples) * 1_000_000).astype(np.int64)
    }
    for axis, place in (("X", 120.0), ("Y", -35.5)):
        wobble = place + 5e-5 * np.sin(2 * np.pi * 7 * time_s)
        columns |= _axis(axis, np.full(samples, place), np.round(wobble, 4), wobble)
    columns |= _axis("Z", set_mm, actual, truth)
    signal = (truth <= SURFACE_MM) & (time_s > 0.1)
    columns["probe.signal"] = signal.astype(np.int8)
    hit = int(np.argmax(signal)) if signal.any() else int(contact_s * 1000)
    return pa.table(columns), hit * 0.001


def _axis(
    axis: str, set_mm: Array, actual: Array, truth: Array
) -> dict[str, npt.NDArray[np.generic]]:
    return {
        f"{axis}.set_mm": set_mm,
        f"{axis}.actual_mm": actual,
        f"{axis}.truth_mm": truth,
        f"{axis}.velocity_mm_s": np.gradient(truth, 0.001),
        f"{axis}.cnc_lag_mm": set_mm - actual,
        f"{axis}.drive_lag_mm": set_mm - truth,
    }


def probed(case: Case, samples: int, feed: float, contact: int, shown: str) -> Facts:
    """What the run of a case leaves: one touch at `contact`, ns, and the messages with `shown`."""
    edge, brake = contact + 3_000 + case.index * 1_000, contact + 3_600_000
    probe = ProbeRecord(True, 1.0, (Contact(contact, {"Z": SURFACE_MM}),), (Edge(edge, True),))
    run = MeasurementRun(
        ("Z",),
        inputs={"Z": 1},
        begin_ns=300_000_000,
        signal_ns=brake,
        end_ns=brake + round(feed * 1e6) + 200_000_000,
    )
    axes = {name: AxisRecord("can1", node, 10_000.0) for node, name in enumerate("XYZ", start=1)}
    axes["Z"] = replace(axes["Z"], latches=(Latch(edge + 1_000, 1),))
    lines = ("N10 G0 X120 Y-35.5", "N20 G100 Z0 F1000", "N30 #MSG")
    return facts(
        sim_ns=samples * 1_000_000,
        end_ns=samples * 1_000_000,
        frame_log_sha256=f"{case.seed:08x}" * 8,
        axes=axes,
        probes={"probe": probe},
        runs=(run,),
        blocks=program(contact / 1e6, run.end_ns / 1e6) if run.end_ns else None,
        alarms=(alarm(50052, contact, axis="Z"),) if case.index == 9 else (),
        messages=tuple(
            MessageRecord(None, (), text)
            for text in (f"MEASURED Z {shown}", "<b>&amp; end of program")
        ),
        notes=tuple(Note("printed", line) for line in lines),
    )


def program(contact_ms: float, end_ms: float) -> BlockTrace:
    """The blocks of a touch: a measurement run that waited 50 ms, its message, the way back."""
    steps = [
        Step("N10 G0 X120", "rapid", 100, 100, 250, path_mm=20.0, travelled_mm=20.0),
        Step(
            "N20 G100 Z0 F1000",
            *("measurement run", 250, 300, end_ms, "signal", 1000.0, 60.0, 41.5),
            line=2,
        ),
        Step("N30 #MSG", "message", end_ms, end_ms, end_ms, line=3),
        Step("N40 G1 Z50", "feed", end_ms, end_ms, end_ms + 40, feed_mm_min=3000.0, line=4),
    ]
    hold = round(0.5 * (300 + contact_ms) * 1e6)
    return block_trace(steps, [(hold, hold + 5_000_000)])


def result(case: Case, samples: int, file: Path | None) -> CaseResult:
    """The run of a case: the numbers of its checks are chosen so that every verdict comes up.

    file: of its series.
    """
    feed = float(case.case.split("_")[1])
    trace, contact_s = probing_trace(feed, samples, np.random.default_rng(case.seed))
    contact = round(contact_s * 1e9)
    error_um = 0.02 * (case.index - 3) if case.index != 6 else 0.31
    uncertainty = (0.004, 0.03, 0.06)[case.index % 3] if case.index != 5 else 0.17
    values: dict[str, tuple[float | str | list[int] | None, float, str]] = {
        "latch_error_um:Z": (error_um, uncertainty, "increment 0.1 µm, input jitter 1 µs"),
        "latch_mm:Z": (SURFACE_MM + error_um / 1000, 0.00005, ""),
        "lag_mm_max:Z": (feed / KV, 0.0, ""),
        "overtravel_mm:Z": (feed * 0.0036 + feed**2 / 2000 + feed / KV, 0.0, ""),
        "msg:N30": (f"{SURFACE_MM + error_um / 1000:.4f}", 0.0, ""),
        "alarms": ([50052] if case.index == 9 else [], 0.0, ""),
    }
    if case.index == 9:
        values["latch_error_um:Z"] = (None, 0.0, "the probe was actuated before the run: no latch")
    checks: list[CheckResult] = [judge(c, *values[c.metric]) for c in case.checks]
    return CaseResult(
        case=case,
        verdict=worst(item.verdict for item in checks),
        checks=checks,
        wall_s=0.41,
        facts=probed(case, samples, feed, contact, f"{SURFACE_MM + error_um / 1000:.4f}"),
        series=kept(trace, file),
    )


def make_campaign(folder: Path, cases: int = 14, samples: int = 4000) -> Path:
    """Write plan and results below `folder`; the last two runs are aborted and in error."""
    (folder / "probe.nc").write_text("N10 G0 X120\n", encoding="utf-8")
    (folder / "machine.toml").write_text("[machine]\n", encoding="utf-8")
    (folder / "probing.csv").write_text(plan_text(cases), encoding="utf-8")
    plan = read_plan(folder / "probing.csv")
    manifest = build_manifest(
        [plan],
        command=["axisrig", "run", "probing.csv", "-o", "out/probing"],
        started="2026-11-21 13:05:12 +01:00",
        output="out/probing",
    )
    out = folder / "out"
    with ResultsWriter(out, [plan], manifest) as writer:
        for case in plan.cases:
            if case.index == cases - 2:
                writer.add(no_values(case, Verdict.ABORTED, "stopped with Ctrl-C", wall_s=0.1))
            elif case.index == cases - 1:
                reason = "FMU AxisRig.Drives.ServoAxis: status error in step 1204 <div>"
                writer.add(no_values(case, Verdict.ERROR, reason, wall_s=0.2))
            else:
                writer.add(result(case, samples, writer.files_of(case.run).trace))
    return out


@pytest.fixture(scope="session")
def campaign(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A results folder of 14 runs with 500 samples each."""
    return make_campaign(tmp_path_factory.mktemp("campaign"), samples=500)


# The campaign as a page in a browser


@pytest.fixture(scope="module")
def folder(campaign: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The campaign with hostile text wherever text of others comes in."""
    part = tmp_path_factory.mktemp("hostile") / "out"
    shutil.copytree(campaign, part)
    for name, columns in (
        ("cases.csv", ("title", "requirement", "program")),
        ("results.csv", ("note", "reference")),
    ):
        with (part / name).open(encoding="utf-8", newline="") as file:
            rows = list(csv.DictReader(file))
        with (part / name).open("w", encoding="utf-8", newline="") as file:
            writer = csv.DictWriter(file, list(rows[0]))
            writer.writeheader()
            writer.writerows({**row, **dict.fromkeys(columns, HOSTILE)} for row in rows)
    path = part / "runs" / "probing-feed_1_a.json"
    content = json.loads(path.read_text(encoding="utf-8"))
    content["facts"]["messages"][0]["shown"] = HOSTILE
    content["facts"]["notes"][0]["text"] = HOSTILE
    content["facts"]["blocks"]["lines"][1]["text"] = HOSTILE
    path.write_text(json.dumps(content), encoding="utf-8")
    build_report(part)
    return part


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    with Browser() as browser:
        yield browser


@pytest.fixture
def page(browser: Browser, folder: Path) -> Browser:
    """The page as it opens, nothing noted yet."""
    browser.open(folder.parent)  # so that the next address is a new page
    browser.errors.clear()
    browser.requested.clear()
    browser.open(folder / "report.html")
    return browser
