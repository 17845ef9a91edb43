"""What is kept of each run while a page is made: whole signals, times, cards, by stand-ins."""

import io
import json
from collections.abc import Mapping
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from tests.reports.swept import CASES, CHECKS, searched

from axisrig.bench.campaign.results.stored import read_results
from axisrig.bench.plan.verdict import Verdict
from axisrig.reports import build
from axisrig.reports.failures.section import SEEN
from axisrig.reports.run import verdict_words


@pytest.fixture
def views(monkeypatch: pytest.MonkeyPatch) -> dict[str, dict[str, Any]]:
    """What `run_view` gives for a run, by its ID: `data` and `clock` can be set before."""
    given: dict[str, dict[str, Any]] = {}

    def view(
        run: Any, columns: Any, output: str, parts: Any, links: Any, *, is_reduced: bool
    ) -> Any:
        own = given.setdefault(run.run, {})
        own["is_reduced"], own["output"] = is_reduced, output
        return {
            "id": run.run, "chart": {}, "data": "", "clock": "simulated", "case": "c",
            "verdict": verdict_words(run.verdict), "title": "", "sentence": "", "failures": [],
            "unjudged": False, **{k: own[k] for k in ("data", "clock") if k in own},
        }  # fmt: skip

    monkeypatch.setattr(build, "run_view", view)
    monkeypatch.setattr(build, "budget_section", lambda folder, run: f"{folder} {run.run}")
    monkeypatch.setattr(build, "search_pictures", lambda run, probes: f"{len(probes)} drawn")
    return given


def rows_of(place: Path, rows: list[tuple[str, str, str]], *more: str) -> Path:
    """rows: plan, run and verdict. more: columns of each run, with their value."""
    names = ",".join(word.partition("=")[0] for word in more)
    values = ",".join(word.partition("=")[2] for word in more)
    cases = [f"{CASES}{',' * bool(more)}{names}"]
    for plan, run, verdict in rows:
        cases.append(f"{plan},c,{run},{verdict},1.5,1,1,,,1,2{',' * bool(more)}{values}")
    (place / "cases.csv").write_text("\n".join([*cases, ""]), encoding="utf-8")
    (place / "results.csv").write_text(f"{CHECKS}\n", encoding="utf-8")
    return place


def made(place: Path, *, is_full: bool = False) -> tuple[Any, list[Mapping[str, Any]]]:
    """What is kept, and what the template of a row gets of each run."""
    rows: list[Mapping[str, Any]] = []

    def row(*, run: Mapping[str, Any]) -> str:
        rows.append(run)
        return f"<tr>{run['id']}</tr>"

    pages: Any = SimpleNamespace(
        row=SimpleNamespace(render=row),
        card=SimpleNamespace(render=lambda card: card["id"]),
        run=SimpleNamespace(render=lambda run: f"<p>{run['id']}</p>"),
        parts=None,
    )
    return build._made(read_results(place), pages, io.StringIO(), is_full=is_full), rows


RUNS = [("p", "a", "pass"), ("p", "b", "fail"), ("p", "c", "aborted"), ("p", "d", "error"),
        ("p", "e", "marginal"), ("p", "f", "pass")]  # fmt: skip


@pytest.mark.parametrize(
    ("size", "whole"),
    [(4, "bcd"), (5, "bc"), (6, "bc"), (10, "b"), (1, "bcde"), (0, "bcde")],
)
def test_signals_of_runs_that_did_not_pass_are_whole_until_they_take_so_much(
    views: dict[str, dict[str, Any]],
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
    size: int,
    whole: str,
) -> None:
    """10 bytes in all; what those take that passed does not count, however large."""
    monkeypatch.setattr(build, "WHOLE_BYTES", 10)
    for _, run, verdict in RUNS:
        views[run] = {"data": "x" * (99 if verdict == "pass" else size)}
    made(rows_of(tmp_path, RUNS))
    assert "".join(run for run, view in views.items() if not view["is_reduced"]) == whole
    made(tmp_path, is_full=True)
    assert not any(view["is_reduced"] for view in views.values())


def test_rows_name_their_plan_where_there_are_several(views: object, tmp_path: Path) -> None:
    for plans, has_plans in (("ppp", False), ("ppq", True)):
        _, rows = made(rows_of(tmp_path, [(p, f"r{n}", "pass") for n, p in enumerate(plans)]))
        assert [row["has_plans"] for row in rows] == [has_plans] * 3


def test_times_are_of_runs_by_the_clock_that_they_had(
    views: dict[str, dict[str, Any]], tmp_path: Path
) -> None:
    """A row about several runs has no time of its own: `runs` counts them."""
    views["b"] = {"clock": "ran"}
    kept, _ = made(rows_of(tmp_path, RUNS[:3]))
    assert kept.seconds == {"sim": [1.5, 1.5], "real": [1.5]}
    kept, rows = made(rows_of(tmp_path, RUNS[:3], "runs=4"))
    assert kept.seconds == {"sim": [], "real": []}
    assert len(rows) == len(kept.rows) == 3


def test_probes_have_rows_and_times_but_no_place_on_the_map(
    views: dict[str, dict[str, Any]], tmp_path: Path
) -> None:
    """Their row has them all, with a picture."""
    kept, rows = made(searched(tmp_path, ("300", "325")))
    names = [row["id"] for row in rows]
    assert names == [*(f"p-c-s{number:02}" for number in range(1, 7)), "p-c"]
    assert [run for run, _ in json.loads(kept.campaign.data())["plans"][0]["runs"]] == ["p-c"]
    assert [row["searched"] for row in rows] == [*[""] * 6, "6 drawn"]
    assert [len(row["probes"]) for row in rows] == [*[0] * 6, 6]
    assert kept.seconds["sim"] == [1.0] * 6


MADE_ANEW = {"recordings": "../..", "recorded_in": "out/p", "output": "out/p/judged/b"}


@pytest.mark.parametrize(
    ("manifest", "output", "is_above"),
    [
        ({}, "b", False),  # without a manifest by the name of the folder
        ({"output": "out/p"}, "out/p", False),
        (MADE_ANEW, "out/p", True),  # `replay` and `bus` find the recordings there
    ],
)
def test_verdicts_made_anew_name_the_folder_that_has_the_recordings(
    views: dict[str, dict[str, Any]],
    tmp_path: Path,
    manifest: dict[str, str],
    output: str,
    is_above: bool,
) -> None:
    """`axisrig judge` writes to judged/NAME of the folder: its budgets are two above."""
    place = tmp_path / "p" / "judged" / "b"
    place.mkdir(parents=True)
    (place / "manifest.json").write_text(json.dumps(manifest), encoding="utf-8")
    _, rows = made(rows_of(place, RUNS[:2]))
    assert {view["output"] for view in views.values()} == {output}
    folder = place / "../.." if is_above else place
    assert [row["budget"] for row in rows] == [f"{folder} a", f"{folder} b"]


def test_every_row_that_did_not_pass_is_on_a_card(
    views: dict[str, dict[str, Any]], tmp_path: Path
) -> None:
    """A worst run is the example of its card; the budget is of the folder with the recording."""
    kept, rows = made(rows_of(tmp_path, RUNS))
    on_card = {row["id"]: bool(row["card"]) for row in rows}
    assert on_card == {"a": False, "b": True, "c": True, "d": True, "e": False, "f": False}
    assert [row["is_example"] for row in rows] == list(on_card.values())
    assert [str(card) for card in kept.cards.made] == ["d", "c", "b"]  # the worst verdict first
    assert [row["budget"] for row in rows] == [f"{tmp_path} {run}" for _, run, _ in RUNS]
    assert Verdict.ERROR > Verdict.ABORTED > Verdict.FAIL


@pytest.mark.parametrize("count", [SEEN - 1, SEEN, SEEN + 1, SEEN + 4])
def test_the_first_cards_are_seen_and_the_others_folded(
    views: object, tmp_path: Path, count: int
) -> None:
    """A card for each case, all of one verdict: they are in the order of the runs."""
    names = [f"r{number:02}" for number in range(count)]
    kept, _ = made(rows_of(tmp_path, [(f"p{run}", run, "fail") for run in names]))
    legends = [SimpleNamespace(legend=text) for text in ("one", "", "two")]
    page = build._page(read_results(tmp_path), kept, legends)  # type: ignore[arg-type]
    view = page["view"]
    assert view["cards"] == names[:SEEN]
    assert view["folded"] == names[SEEN:]
    assert (view["failed"], view["left_out"]) == (count, 0)
    assert view["legends"] == ["one", "two"]
    assert view["rows"] == [f"<tr>{run}</tr>" for run in names]
