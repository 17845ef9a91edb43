"""The page opens with what did not pass; each run is one row that opens on demand."""

import csv
import json
import re
import shutil
from html import unescape
from pathlib import Path

import pytest
from tests.reports.pages import opened

from axisrig.reports import build
from axisrig.reports.build import build_report
from axisrig.reports.failures import section
from axisrig.reports.parts.envelope import BINS, KEPT_ROWS

RANK = ["error", "aborted", "fail", "inconclusive"]


@pytest.fixture(scope="module")
def source(campaign: Path) -> str:
    return build_report(campaign).read_text(encoding="utf-8")


def cards(source: str) -> list[tuple[str, str, str]]:
    """Run, verdict and text of each card."""
    pattern = r'<article class="card v-(\w+)-edge" data-run="([\w.-]+)"[^>]*>(.*?)</article>'
    return [(run, verdict, body) for verdict, run, body in re.findall(pattern, source, re.DOTALL)]


def rows(campaign: Path, name: str) -> list[dict[str, str]]:
    with (campaign / name).open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def test_what_did_not_pass_comes_before_the_runs_the_worst_first(
    source: str, campaign: Path
) -> None:
    found = cards(source)
    bad = {row["run"]: row["verdict"] for row in rows(campaign, "cases.csv")}
    bad = {run: verdict for run, verdict in bad.items() if verdict in RANK}
    assert {run: verdict for run, verdict, _ in found} == bad
    assert [verdict for _, verdict, _ in found] == sorted(bad.values(), key=RANK.index)
    assert source.index('id="failures"') < source.index('id="summary"')


def test_each_says_why_in_a_sentence_with_a_picture(source: str) -> None:
    """The error of feed_50_a is 0.31 um against -0.2 .. 0.2 (conftest): 0.11 um above."""
    answer = {run: unescape(body) for run, _, body in cards(source)}
    late = answer["probing-feed_50_a"]
    assert "latch_error_um:Z is 0.11 µm above its upper limit 0.2 µm" in late
    assert '<svg class="pic"' in late
    assert '<svg class="bar"' in late
    assert "the probe was actuated before the run: no latch" in answer["probing-feed_5_b"]
    assert "stopped with Ctrl-C" in answer["probing-feed_25_b"]
    assert "no verdict: FMU AxisRig.Drives.ServoAxis: status error" in answer["probing-feed_50_b"]


def test_a_run_shows_its_failures_above_everything_else(source: str) -> None:
    run = opened(source)["probing-feed_50_a"].html
    assert run.index("0.11 µm above its upper limit") < run.index('class="files"')
    assert run.index('class="files"') < run.index('class="body"')
    assert "above its upper limit" not in opened(source)["probing-feed_1_a"].html


@pytest.mark.long
def test_many_failures_leave_room_for_the_runs(
    campaign: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(section, "CARDS", 2)
    part = tmp_path / "part"
    shutil.copytree(campaign, part)
    page = build_report(part).read_text(encoding="utf-8")
    assert len(cards(page)) == 2
    assert "Did not pass: 6 of 14 runs" in page
    assert "4 more did not pass: they are in the table." in page


def test_a_run_is_found_by_its_words(source: str) -> None:
    """Name, title, requirement, rig, inputs, metrics and alarms, all in small letters."""
    find = dict(re.findall(r'data-run="([\w.-]+)" data-sim="[\d.]+" data-find="([^"]*)"', source))
    words = unescape(find["probing-feed_5_b"])
    for word in (
        *("feed_5_b", "touch at 5 mm/s", "req-14", "machine.toml", "probe.nc", "lag_mm_max:z"),
        *("plant:probe.trigger_delay_us=12", "50052 probe of axis z is actuated"),
    ):
        assert word in words, word
    assert "50052" not in find["probing-feed_1_a"]


@pytest.mark.long
def test_files_of_a_run_are_named_from_the_page(campaign: Path, tmp_path: Path) -> None:
    """The command was in the folder of the plan: `axisrig run probing.csv -o out/probing`."""
    part = tmp_path / "part"
    shutil.copytree(campaign, part)
    manifest = json.loads((part / "manifest.json").read_text(encoding="utf-8"))
    manifest["plans"][0]["path"] = "probing.csv"
    (part / "manifest.json").write_text(json.dumps(manifest), encoding="utf-8")
    run = opened(build_report(part))["probing-feed_1_a"].html
    links = re.findall(r'<a href="([^"]+)">([^<]+)</a>', run)
    assert ("traces/probing-feed_1_a.parquet",) * 2 in links
    assert ("runs/probing-feed_1_a.json",) * 2 in links
    assert ("../../probing.csv", "probing.csv:2") in links
    assert ("../../probe.nc", "probe.nc") in links
    assert all((campaign / link).is_file() for link, _ in links if not link.startswith(".."))


@pytest.mark.parametrize(
    ("path", "output", "expected"),
    [
        ("plans/a.csv", "out/a", "../../plans/a.csv"),
        ("/x/a.csv", "/x/out", "../a.csv"),
        ("plans/a b.csv", "out", "../plans/a%20b.csv"),
        ("/x/a.csv", "out", ""),
        ("plans/a.csv", "/x/out", ""),
        ("../a.csv", "out", ""),
        ("a.csv", "../out", ""),
    ],
)
def test_an_address_depends_on_the_two_names_alone(path: str, output: str, expected: str) -> None:
    assert build.relative_address(path, output) == expected


def test_what_was_tested_on_what_is_said_first(source: str) -> None:
    head = source.split("<main>", maxsplit=1)[0]
    assert "probe.nc on machine.toml: 14 runs" in head


@pytest.mark.long
def test_all_samples_of_runs_that_did_not_pass_are_kept(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from tests.reports.conftest import make_campaign  # noqa: PLC0415

    out = make_campaign(tmp_path, cases=9, samples=2500)
    runs = opened(build_report(out))
    kept = {run: opened_.chart.get("rows") for run, opened_ in runs.items()}
    verdicts = {row["run"]: row["verdict"] for row in rows(out, "cases.csv")}
    for run, verdict in verdicts.items():
        if verdict == "pass":
            assert kept[run] <= 2 * BINS + KEPT_ROWS + 4
            assert "2500 samples" in runs[run].html
        elif kept[run]:
            assert kept[run] == 2500
            assert "samples" not in runs[run].html
    assert set(verdicts.values()) >= {"pass", "fail"}
    monkeypatch.setattr(build, "WHOLE_BYTES", 1)  # the first one takes it all
    rest = [opened_.chart.get("rows") for opened_ in opened(build_report(out)).values()]
    assert rest.count(2500) == 1
    full = opened(build_report(out, is_full=True))
    assert {opened_.chart.get("rows") for opened_ in full.values()} == {2500, None}
