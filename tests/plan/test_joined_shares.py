"""Shares of a campaign that were never run are joined: whose they are, and what comes with them."""

from collections.abc import Sequence
from contextlib import nullcontext
from pathlib import Path

import pytest
from results_setup import TEXT, PlanWriter, add, rows

from axisrig.bench.bus.can.logs import SEGMENT_MARK
from axisrig.bench.campaign.results.manifest import build_manifest
from axisrig.bench.campaign.results.stored import read_results
from axisrig.bench.campaign.results.writer import ResultsWriter
from axisrig.bench.campaign.sharing import merge
from axisrig.bench.plan.assignment import parse_assignment
from axisrig.bench.plan.plan import Plan, read_plan
from axisrig.bench.rig.settings import AS_CANOPEN, FORCED
from axisrig.kernel.errors import UserError

EDGE = "set:Z.edge=NEG"


@pytest.fixture
def plan(write_plan: PlanWriter) -> Plan:
    return read_plan(write_plan(TEXT))


def share(
    folder: Path,
    plan: Plan,
    runs: str,
    options: Sequence[str] = (),
    logs: Sequence[str] = (".blf",),
) -> Path:
    """A results folder with these cases of the plan, each with bus logs of these endings."""
    command = ["axisrig", "run", str(plan.path), "-o", str(folder), *options]
    made = build_manifest([plan], command=command, started="now", output=str(folder))
    with ResultsWriter(folder, [plan], made) as writer:
        for case in plan.cases:
            if case.case in runs:
                (blf,) = writer.files_of(case.run).bus_logs
                for ending in logs:
                    blf.with_name(f"{case.run}{ending}").write_text(f"{case.run} {ending}")
                add(writer, case)
    return folder


def inside(folder: Path) -> dict[str, bytes]:
    """The files of runs of a folder."""
    return {
        f"{kind}/{path.name}": path.read_bytes()
        for kind in ("bus", "runs", "traces")
        for path in (folder / kind).iterdir()
    }


@pytest.mark.long
def test_every_file_of_a_run_comes_with_it_of_each_segment_too(plan: Plan, tmp_path: Path) -> None:
    """Runs whose ids begin with each other keep their own; a log of each segment is one of both."""
    logs = (".blf", f"{SEGMENT_MARK}can1.pcap", f"{SEGMENT_MARK}can2.pcap")
    one = share(tmp_path / "one", plan, "ac", logs=logs)
    other = share(tmp_path / "other", plan, "b", logs=logs)
    done = merge([one, other], tmp_path / "all", started="later")
    assert (done.runs, done.missing, done.doubled, done.bare) == (3, [], [], [])
    assert inside(tmp_path / "all") == inside(one) | inside(other)
    assert [len(found) for found in (inside(one), inside(other))] == [10, 5]
    joined = read_results(tmp_path / "all")
    assert [run.run for run in joined.runs] == [case.run for case in plan.cases]
    assert all(not run.altered for run in joined.runs)


def test_a_log_that_is_not_as_the_run_has_written_it_is_refused(plan: Plan, tmp_path: Path) -> None:
    """The log of any segment, of any share."""
    ending = f"{SEGMENT_MARK}can2.pcap"
    one = share(tmp_path / "one", plan, "ac")
    other = share(tmp_path / "other", plan, "b", logs=(".blf", ending))
    (other / "bus" / f"probing-b{ending}").write_text("of another run")
    with pytest.raises(UserError, match=f"not as the run has written it: bus/probing-b{ending}"):
        merge([one, other], tmp_path / "all", started="later")


@pytest.mark.parametrize(
    ("first", "second", "is_one"),
    [
        # What a share may have of its own
        (
            ["--shard", "1/2", "-j", "4", "--timeout", "5", "-k", "first or second"],
            ["--shard=2/2", "-j1", "--isolate", "--live", "-k", "first or second"],
            True,
        ),
        # What makes another campaign
        (["-k", "first or second"], ["-k", "first or third"], False),
        (["-k", "first or second"], [], False),
        (["--set", EDGE], ["--set", "set:Z.edge=POS"], False),
        ([f"--set={EDGE}"], ["--set=set:Z.edge=POS"], False),
        (["--set", EDGE], [], False),
        (["--force"], [], False),
        (["--as-canopen"], [], False),
    ],
)
def test_shares_of_one_campaign_have_the_options_that_decide_on_results(
    plan: Plan, tmp_path: Path, first: list[str], second: list[str], is_one: bool
) -> None:
    one, other = (
        share(tmp_path / name, plan, "", options)
        for name, options in (("one", first), ("other", second))
    )
    with nullcontext() if is_one else pytest.raises(UserError, match="other options than"):
        merge([one, other], tmp_path / "all", started="later")
    assert (tmp_path / "all").exists() == is_one


@pytest.mark.parametrize("options", [["--set", EDGE], [f"--set={EDGE}"]])
def test_the_joined_folder_has_the_inputs_and_the_choice_of_the_command(
    plan: Plan, tmp_path: Path, options: list[str]
) -> None:
    """However they are written; runs that -k leaves out are none that is missing."""
    given = plan.with_inputs([parse_assignment(EDGE)])
    words = [*options, "-k", "first or second"]
    one, other = (share(tmp_path / name, given, name, words) for name in "ab")
    done = merge([one, other], tmp_path / "all", started="later")
    assert (done.runs, done.missing) == (2, [])
    found = rows(tmp_path / "all" / "plans" / "probing.csv")
    assert [row["set:Z.edge"] for row in found] == ["NEG"] * 3


@pytest.mark.parametrize("first", ["one", "other"])
def test_a_run_of_two_shares_comes_from_the_first_that_is_named(
    plan: Plan, tmp_path: Path, first: str
) -> None:
    """Their bus logs may differ: an asc log has a date. With them come those of the same folder."""
    folders = {
        name: share(tmp_path / name, plan, runs, logs=(ending,))
        for name, runs, ending in (("one", "ac", ".asc"), ("other", "cb", ".blf"))
    }
    named = sorted(folders, key=lambda name: name != first)
    done = merge([folders[name] for name in named], tmp_path / "all", started="later")
    assert (done.runs, done.missing, done.doubled) == (3, [], ["probing-c"])
    kept = inside(tmp_path / "all")
    of_first, of_other = (
        {name: data for name, data in inside(folders[one]).items() if "-c" in name} for one in named
    )
    assert of_first != of_other
    assert {name: data for name, data in kept.items() if "-c" in name} == of_first


def test_a_share_with_flags_is_joined_with_their_inputs(plan: Plan, tmp_path: Path) -> None:
    """Runs depend on what a flag assigns, as on what --set does."""
    given = plan.with_inputs([parse_assignment(text) for text in (FORCED, AS_CANOPEN)])
    one = share(tmp_path / "one", given, "a", ["--force", "--as-canopen"])
    done = merge([one], tmp_path / "all", started="later")
    assert (done.runs, list(done.missing)) == (1, ["probing-b", "probing-c"])
    found = rows(tmp_path / "all" / "plans" / "probing.csv")
    for text in (FORCED, AS_CANOPEN):
        column, _, value = text.partition("=")
        assert [row[column] for row in found] == [value] * 3
