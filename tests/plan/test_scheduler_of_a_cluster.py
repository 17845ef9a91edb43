"""A campaign and the scheduler of its cluster: how it is reached, what it gets, how it is left."""

import pickle
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from tests.plan.cases import case_of as made_case

from axisrig.bench.campaign import cluster
from axisrig.bench.campaign.results.build_info import sources_sha256
from axisrig.bench.campaign.results.writer import CaseResult, RunFiles
from axisrig.bench.campaign.runner import Limits, no_stopwatch
from axisrig.bench.plan.case import Case
from axisrig.bench.plan.verdict import Verdict
from axisrig.kernel.errors import UserError

ADDRESS = "tcp://127.0.0.1:8786"


def case_of(place: Path, name: str, text: str = "") -> Case:
    """A case with a program and a rig of its own folder."""
    for file, content in ((f"{name}.nc", text or f"program of {name}"), ("rig.toml", "rig")):
        (place / file).write_text(content, encoding="utf-8")
    return made_case(
        name, place / "rig.toml", program=place / f"{name}.nc", file=place / "p.csv", folder=place
    )


class Future:
    """What was submitted: its result, or an error of the worker."""

    def __init__(self, give: Callable[[], Any], key: str = "") -> None:
        self.give, self.key, self.status = give, key, "finished"
        self.error: Exception | None = None

    def result(self) -> Any:
        return self.give()

    def exception(self) -> Exception | None:
        return self.error


class Cluster:
    """A scheduler that works at once.

    order: numbers of its runs in the order in which they end. dies: numbers of those that fail.
    """

    def __init__(self, order: Sequence[int] = (), dies: Sequence[int] = ()) -> None:
        self.order, self.dies = order, dies
        self.words: tuple[Any, ...] = ()
        self.blobs: list[Future] = []
        self.runs: list[Future] = []
        self.cancelled: list[list[Future]] = []
        self.is_closed = False
        self.loop = "its loop"

    def client(self, *words: Any, **named: Any) -> "Cluster":
        self.words = (*words, named)
        return self

    def submit(self, work: Callable[..., Any], *given: Any, **named: Any) -> Future:
        if work is bytes:
            self.blobs.append(Future(lambda: bytes(*given), named["key"]))
            return self.blobs[-1]
        packed, needed = given
        contents = {key: blob.result() for key, blob in needed.items()}
        future = Future(lambda: work(packed, contents))
        if len(self.runs) in self.dies:
            future.status, future.error = "error", RuntimeError("killed\n 3 times")
        self.runs.append(future)
        return future

    def as_completed(self, futures: list[Future], loop: str) -> Iterator[Future]:
        assert loop == self.loop
        assert futures == self.runs
        return iter([futures[n] for n in self.order or range(len(futures))])

    def cancel(self, futures: list[Future]) -> None:
        self.cancelled.append(futures)

    def close(self) -> None:
        self.is_closed = True


@pytest.fixture
def connect(monkeypatch: pytest.MonkeyPatch) -> Callable[[Cluster], Cluster]:
    """Return `connect(cluster)`: dask.distributed is this cluster, whose workers run nothing."""

    def work(packed: bytes, contents: Mapping[str, bytes]) -> bytes:
        case = pickle.loads(packed).case
        texts = sorted(content.decode() for content in contents.values())
        result = CaseResult(case, Verdict.PASS, [])
        result.log = texts
        return pickle.dumps(cluster._Returned(result, {}))

    def made(one: Cluster) -> Cluster:
        module = SimpleNamespace(Client=one.client, as_completed=one.as_completed)
        monkeypatch.setitem(sys.modules, "distributed", module)
        monkeypatch.setattr(cluster, "_work", work)
        monkeypatch.setattr(cluster, "files_of_case", lambda case: [case.program, case.rig])
        return one

    return made


def results(cases: Sequence[Case]) -> Iterator[CaseResult]:
    return cluster.run_on_cluster(cases, lambda _: RunFiles([]), ADDRESS, Limits(), no_stopwatch)


@pytest.mark.parametrize(
    "error",
    [OSError("refused"), TimeoutError("10 s"), ConnectionRefusedError(), ValueError("no scheme")],
)
@pytest.mark.parametrize("address", [ADDRESS, "udp6://host:8786", "tpc://host", "8786"])
def test_an_address_where_no_scheduler_answers_is_the_users_error(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, error: Exception, address: str
) -> None:
    """Also one that the client cannot read: an unknown scheme is a ValueError."""

    def client(*_: Any, **__: Any) -> None:
        raise error

    module = SimpleNamespace(Client=client, as_completed=None)
    monkeypatch.setitem(sys.modules, "distributed", module)
    run = cluster.run_on_cluster(
        [case_of(tmp_path, "a")], lambda _: RunFiles([]), address, Limits(), no_stopwatch
    )
    with pytest.raises(UserError, match="no scheduler answers") as caught:
        next(run)
    assert caught.value.value == address
    assert caught.value.__cause__ is error


def test_without_dask_no_scheduler_is_asked(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(UserError, match=r"dask\.distributed is not installed") as caught:
        next(results([case_of(tmp_path, "a")]))
    assert caught.value.hint == "pip install 'axisrig[dask]' brings it"


def test_the_scheduler_is_that_of_the_address_and_of_no_other_client(
    connect: Callable[[Cluster], Cluster], tmp_path: Path
) -> None:
    one = connect(Cluster())
    assert [found.verdict for found in results([case_of(tmp_path, "a")])] == [Verdict.PASS]
    assert one.words == (ADDRESS, {"timeout": 10, "set_as_default": False})


@pytest.mark.parametrize("order", [(0, 1, 2), (2, 0, 1), (1, 2, 0)])
def test_each_result_is_of_its_case_in_the_order_in_which_they_end(
    connect: Callable[[Cluster], Cluster], tmp_path: Path, order: tuple[int, ...]
) -> None:
    connect(Cluster(order))
    cases = [case_of(tmp_path, name) for name in "abc"]
    found = list(results(cases))
    assert [one.case for one in found] == [cases[n] for n in order]
    assert [one.log for one in found] == [[f"program of {'abc'[n]}", "rig"] for n in order]


def test_a_content_goes_to_the_cluster_once_whatever_its_name(
    connect: Callable[[Cluster], Cluster], tmp_path: Path
) -> None:
    """Three programs, two of them equal, and one rig: three contents, and each run has its own."""
    one = connect(Cluster())
    cases = [case_of(tmp_path, *words) for words in (("a", "same"), ("b", "same"), ("c", "other"))]
    found = list(results(cases))
    assert sorted(blob.result() for blob in one.blobs) == [b"other", b"rig", b"same"]
    assert len({blob.key for blob in one.blobs}) == 3
    assert all(blob.key.startswith("axisrig-") for blob in one.blobs)
    assert [result.log for result in found] == [["rig", "same"], ["rig", "same"], ["other", "rig"]]


@pytest.mark.parametrize("dies", [(0,), (2,), (0, 1, 2)])
def test_a_case_that_no_worker_could_run_is_in_error_and_the_others_go_on(
    connect: Callable[[Cluster], Cluster], tmp_path: Path, dies: tuple[int, ...]
) -> None:
    connect(Cluster(dies=dies))
    found = list(results([case_of(tmp_path, name) for name in "abc"]))
    assert [one.case.case for one in found] == ["a", "b", "c"]
    verdicts = [Verdict.ERROR if n in dies else Verdict.PASS for n in range(3)]
    assert [one.verdict for one in found] == verdicts
    for n in dies:
        assert found[n].error == "no worker could run it: killed 3 times"


def test_at_the_end_nothing_is_left_to_cancel_and_the_client_is_closed(
    connect: Callable[[Cluster], Cluster], tmp_path: Path
) -> None:
    one = connect(Cluster())
    list(results([case_of(tmp_path, name) for name in "ab"]))
    assert (one.cancelled, one.is_closed) == ([[]], True)


def test_who_stops_early_cancels_what_has_not_ended(
    connect: Callable[[Cluster], Cluster], tmp_path: Path
) -> None:
    one = connect(Cluster((1, 0, 2)))
    run = results([case_of(tmp_path, name) for name in "abc"])
    assert next(run).case.case == "b"
    assert not one.is_closed
    run.close()  # type: ignore[attr-defined]
    assert one.cancelled == [[one.runs[0], one.runs[2]]]
    assert one.is_closed


def test_a_client_that_cannot_cancel_is_closed_all_the_same(
    connect: Callable[[Cluster], Cluster], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    one = connect(Cluster())

    def cancel(_: Any) -> None:
        raise OSError("the scheduler has gone")

    monkeypatch.setattr(one, "cancel", cancel)
    assert len(list(results([case_of(tmp_path, "a")]))) == 1
    assert one.is_closed


@pytest.mark.parametrize(("differs", "verdict"), [(False, Verdict.PASS), (True, Verdict.ERROR)])
def test_a_parcel_names_the_sources_of_who_sent_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, differs: bool, verdict: Verdict
) -> None:
    """A worker with others gives a reason, and that is the error of the case."""
    case = case_of(tmp_path, "a")
    monkeypatch.setattr(cluster, "files_of_case", lambda one: [one.program, one.rig])
    parcel, _ = cluster._packed(case, RunFiles([]), Limits(), no_stopwatch)
    assert parcel.sources_sha256 == sources_sha256()
    returned = cluster._Returned(CaseResult(parcel.case, Verdict.PASS, []), {})
    if differs:
        returned = cluster._Returned(None, {}, "the worker has another axisrig")
    found = cluster._unpacked(case, pickle.dumps(returned), lambda _: RunFiles([]))
    assert found.verdict is verdict
    assert found.error == ("the worker has another axisrig" if differs else None)
