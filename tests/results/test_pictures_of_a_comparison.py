"""Lines over each other, the pages of `diff` and `trend`, and a trend in words."""

import math
import re
from collections.abc import Sequence
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
from markupsafe import Markup
from tests.recordings import kept

from axisrig.bench.plan.verdict import Verdict
from axisrig.results.compare import page
from axisrig.results.compare.drawing import WIDTH, _reduced, overlay
from axisrig.results.compare.trend import CaseTrend, Point, Trend
from axisrig.results.compare.words import trend_lines

RIGHT_PX = WIDTH - 8.0  # the right edge of the field
INSET_PX = 12.0  # from the frame to the outermost dots


def line(places: Sequence[float], values: Sequence[float]) -> Any:
    return np.array(places, dtype=float), np.array(values, dtype=float)


def polylines(text: str) -> dict[str, list[tuple[float, ...]]]:
    """Class of each line -> its points, in px."""
    return {
        kind: [tuple(map(float, point.split(","))) for point in points.split()]
        for kind, points in re.findall(r'<polyline class="([\w-]+)" points="([^"]*)"', text)
    }


# Lines over each other


def test_two_lines_are_on_one_scale_the_first_one_is_that_before() -> None:
    """0 .. 10 and 5 .. 20 across: 20 is at the right edge; larger values are higher."""
    text = overlay("s", {"a": line([0, 10], [0, 4]), "b": line([5, 20], [4, 2])}, ("0", "20 ms"))
    found = polylines(text)
    assert list(found) == ["cmp-before", "cmp-after"]
    (x0, low), (x10, high) = found["cmp-before"]
    (x5, same), (x20, half) = found["cmp-after"]
    assert x20 == RIGHT_PX
    across = [(x - x0) / (RIGHT_PX - x0) for x in (x5, x10)]
    assert across == pytest.approx([0.25, 0.5], abs=2e-3)
    assert (same, high < low) == (high, True)
    assert half == pytest.approx((low + high) / 2.0, abs=0.11)
    assert 'aria-label="s: a, b"' in text
    ends = re.findall(r'<text x="([\d.]+)" y="146"(?: text-anchor="end")?>([^<]*)<', text)
    assert [word for _, word in ends] == ["0", "20 ms"]
    assert float(ends[0][0]) == pytest.approx(x0, abs=0.06)


def test_a_line_alone_is_no_line_before_and_what_has_no_number_is_left_out() -> None:
    nothing = line([0, 30], [math.nan, math.inf])
    text = overlay("s", {"a": nothing, "b": line([0, 1, 2], [1, math.nan, 3])}, ("", ""))
    found = polylines(text)
    assert list(found) == ["cmp-after"]
    assert len(found["cmp-after"]) == 2
    assert found["cmp-after"][-1][0] == RIGHT_PX
    assert 'aria-label="s: b"' in text


def test_limits_are_in_the_picture_and_on_the_scale_of_the_values() -> None:
    text = overlay("s", {"a": line([0, 1], [0, 10])}, ("", ""), [5.0, 20.0, -10.0])
    ((_, low), (_, high)) = polylines(text)["cmp-after"]
    limits = [float(y) for y in re.findall(r'class="cmp-limit"[^>]* y1="([\d.]+)"', text)]
    unit = (low - high) / 10.0
    assert limits == pytest.approx([low - 5 * unit, low - 20 * unit, low + 10 * unit], abs=0.2)
    assert 18.0 <= min(limits) < max(limits) <= 134.0


def test_dots_say_value_and_name_and_are_inside_the_frame() -> None:
    """At the value of the line; more values than names is no mistake."""
    both = line([0, 1, 3], [1.5, 2.25, 0.5])
    text = overlay("s", {"a": both}, ("", ""), has_dots=True, names=["one <", "two"])
    assert re.findall(r"<title>([^<]*)</title>", text) == ["1.5, one &lt;", "2.25, two", "0.5"]
    dots = [tuple(map(float, at)) for at in re.findall(r'cx="([\d.]+)" cy="([\d.]+)"', text)]
    assert dots == polylines(text)["cmp-after"]
    ((left,),) = [re.findall(r'<text x="([\d.]+)" y="146">', text)]
    room = INSET_PX * (RIGHT_PX - float(left)) / WIDTH / (1 + 2 * INSET_PX / WIDTH)
    assert dots[0][0] - float(left) == pytest.approx(room, abs=0.2)
    assert RIGHT_PX - dots[-1][0] == pytest.approx(room, abs=0.2)
    assert "<circle" not in overlay("s", {"a": both}, ("", ""))


# Signals of two runs


def run_of(path: Path, times_ms: Sequence[float], **signals: Sequence[Any]) -> Any:
    table = pa.table(
        {"time_ns": np.array([round(at * 1e6) for at in times_ms], dtype=np.int64)}
        | {name.replace("__", "."): values for name, values in signals.items()}
    )
    kept(table, path)
    return SimpleNamespace(trace=path)


def drawn(monkeypatch: pytest.MonkeyPatch, before: Any, after: Any) -> list[tuple[Any, ...]]:
    """Title, lines and ends of each picture of a pair."""
    found: list[tuple[Any, ...]] = []

    def draw(title: str, lines: Any, ends: Any) -> str:
        shown = {name: (at.tolist(), values.tolist()) for name, (at, values) in lines.items()}
        found.append((title, shown, ends))
        return "picture"

    monkeypatch.setattr(page, "overlay", draw)
    pair: Any = SimpleNamespace(before=before, after=after)
    assert page.pictures(pair) == ["picture"] * len(found)
    return found


def test_signals_that_differ_most_by_their_range_are_drawn(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Three of four, each with its difference: 1 of 2, 30 of 100, 2 of 10; 1 of 100 is none."""
    ways = {"Z__a": (0.0, 1.0, 2.0), "Z__b": (0.0, 50.0, 100.0), "Z__c": (0.0, 5.0, 10.0),
            "Z__d": (0.0, 50.0, 100.0), "Z__same": (1.0, 2.0, 3.0)}  # fmt: skip
    gaps = {"Z__a": 1.0, "Z__b": 30.0, "Z__c": -2.0, "Z__d": 1.0, "Z__same": 0.0}
    after = {name: (first, middle + gaps[name], last) for name, (first, middle, last) in
             ways.items()}  # fmt: skip
    found = drawn(
        monkeypatch,
        run_of(
            tmp_path / "a.parquet", (0, 1, 2), **ways, Z__word=["x", "y", "z"], Z__gone=[1, 2, 3]
        ),
        run_of(tmp_path / "b.parquet", (0, 1, 2), **after, Z__word=["x", "y", "q"]),
    )
    names = ["Z.a", "Z.b", "Z.c"]
    assert [title for title, *_ in found] == [
        title for name in names for title in (name, f"difference of {name}")
    ]
    assert [next(iter(lines.values()))[1] for _, lines, _ in found[1::2]] == [
        [0.0, 1.0, 0.0], [0.0, 30.0, 0.0], [0.0, -2.0, 0.0],
    ]  # fmt: skip
    assert [list(lines) for _, lines, _ in found[:2]] == [
        ["before", "after"],
        ["after minus before"],
    ]


@pytest.mark.parametrize("turn", [1, -1])
def test_a_difference_counts_by_the_wider_range_of_both_runs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, turn: int
) -> None:
    """5 of the 10 that one run has, and of nothing in the other; 0.9 of 1 is more."""
    one = {"Z__stands": (0.0, 10.0, 0.0), "Z__moves": (0.0, 1.0, 1.0)}
    other = {"Z__stands": (5.0, 5.0, 5.0), "Z__moves": (0.0, 1.0, 0.1)}
    runs = [run_of(tmp_path / f"{turn}{n}.parquet", (0, 1, 2), **ways)
            for n, ways in enumerate((one, other)[::turn])]  # fmt: skip
    found = drawn(monkeypatch, *runs)
    assert [title for title, *_ in found[::2]] == ["Z.moves", "Z.stands"]


@pytest.mark.parametrize(
    ("name", "gap", "is_drawn"),
    [
        # A position has six digits: half of the last one is none, of numbers that are alike
        ("Z__set_mm", 0.4e-6, False), ("Z__set_mm", 0.6e-6, True), ("Z__set_mm", -0.6e-6, True),
        ("Z__set_mm", -0.4e-6, False),
        # Of a signal that no report knows 1e-9 of the largest amount
        ("Z__own", 0.9e-9, False), ("Z__own", 1.2e-9, True),
    ],
)  # fmt: skip
def test_a_difference_that_no_digit_of_a_report_shows_is_none(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str, gap: float, is_drawn: bool
) -> None:
    before, after = (
        run_of(tmp_path / f"{n}.parquet", (0, 1, 2), **{name: (-1.0, 0.25 + own, 0.5)})
        for n, own in enumerate((0.0, gap))
    )
    assert len(drawn(monkeypatch, before, after)) == 2 * is_drawn


def test_only_instants_of_both_are_compared_and_the_longer_one_is_drawn_whole(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    ((title, lines, ends), (_, differing, _)) = drawn(
        monkeypatch,
        run_of(tmp_path / "a.parquet", (1, 2, 3), Z__set_mm=(0.0, 1.0, 9.0)),
        run_of(tmp_path / "b.parquet", (2, 2.5, 4, 8), Z__set_mm=(4.0, 7.0, 9.0, 9.0)),
    )
    assert (title, ends) == ("Z.set_mm, mm", ("1 ms", "8 ms"))
    assert lines["after"] == ([2e6, 2.5e6, 4e6, 8e6], [4.0, 7.0, 9.0, 9.0])
    assert differing == {"after minus before": ([2e6], [3.0])}
    apart = (run_of(tmp_path / "c.parquet", (1, 2), Z__set_mm=(0.0, 1.0)),
             run_of(tmp_path / "d.parquet", (3, 4), Z__set_mm=(5.0, 6.0)))  # fmt: skip
    assert drawn(monkeypatch, *apart) == []
    lacking: Any = SimpleNamespace(trace=None)
    assert drawn(monkeypatch, apart[0], lacking) == drawn(monkeypatch, lacking, apart[0]) == []


# The pages


def viewed(monkeypatch: pytest.MonkeyPatch) -> list[Any]:
    found: list[Any] = []

    def write(path: Path, template: str, view: Any) -> Path:
        found.append((template, view))
        return path

    monkeypatch.setattr(page, "_write", write)
    return found


def pair_of(name: str, *ens: float, is_worse: bool = False, is_changed: bool = True) -> Any:
    metrics = [SimpleNamespace(en=en) for en in ens]
    return SimpleNamespace(name=name, is_worse=is_worse, is_changed=is_changed, metrics=metrics)


def test_the_page_of_a_comparison_begins_with_what_got_worse(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Then by the surest shift of a metric; the first 20 have pictures."""
    views = viewed(monkeypatch)
    monkeypatch.setattr(page, "pictures", lambda pair: [Markup(f"<{pair.name}>")])
    pairs = [pair_of("small", 1.0), pair_of("none"), pair_of("same", 99.0, is_changed=False),
             pair_of("large", 0.5, 7.0), pair_of("worse", 0.1, is_worse=True),
             *(pair_of(f"more{n}") for n in range(17))]  # fmt: skip
    comparison: Any = SimpleNamespace(pairs=pairs, worse=lambda: ["worse"])
    folders: Any = [
        SimpleNamespace(folder=tmp_path / "a", manifest={"axisrig": "1.2", "started": "monday"}),
        SimpleNamespace(folder=tmp_path / "b", manifest={"started": "friday"}),
    ]
    assert page.write_diff(tmp_path / "d.html", comparison, folders, ["x"]) == tmp_path / "d.html"  # type: ignore[list-item]
    ((template, view),) = views
    assert template == "diff.html"
    assert [one.name for one in view["changed"]][:4] == ["worse", "large", "small", "none"]
    assert len(view["drawn"]) == page.RUNS_DRAWN == 20
    assert (view["drawn"]["worse"], view["not_drawn"]) == ("<worse>", 1)
    assert view["made"] == ["axisrig 1.2, monday", "friday"]
    assert view["folders"] == [str(tmp_path / "a"), str(tmp_path / "b")]


TREND = Trend(
    "m:Z",
    ("one", "two", "three"),
    ("", "", ""),
    (
        CaseTrend("p-a", "um", (-1.0, 9.0), (Point(0, 1, 2.0, math.nan, Verdict.PASS),
                                             Point(2, 3, 4.5, 0.25, Verdict.FAIL))),
        CaseTrend("p-b", "", (), (Point(1, 2, 7.0, 0.0, Verdict.MARGINAL),)),
    ),
)  # fmt: skip


def test_a_trend_in_words_has_limits_spread_and_the_worst_verdict() -> None:
    assert [" ".join(line.split()) for line in trend_lines(TREND)] == [
        "p-a m:Z um, limits -1 .. 9",
        "one 2 n 1 pass",
        "three 4.5 s 0.25 n 3 fail",
        "p-b m:Z",
        "two 7 s 0 n 2 marginal",
    ]


def test_the_page_of_a_trend_has_the_places_of_the_folders(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """A folder without the case leaves its place empty."""
    views, asked = viewed(monkeypatch), list[Any]()

    def draw(title: str, lines: Any, ends: Any, limits: Any, **how: Any) -> str:
        places, means = lines["mean"]
        asked.append((title, places.tolist(), means.tolist(), ends, limits, how))
        return title

    monkeypatch.setattr(page, "overlay", draw)
    page.write_trend(tmp_path / "t.html", TREND)
    ends = ("one", "three")
    assert asked == [
        ("m:Z, um", [0.0, 2.0], [2.0, 4.5], ends, (-1.0, 9.0),
         {"has_dots": True, "names": ["one, n 1", "three, n 3"]}),
        ("m:Z", [1.0], [7.0], ends, (), {"has_dots": True, "names": ["two, n 2"]}),
    ]  # fmt: skip
    assert views[0][1]["drawn"] == {"p-a": "m:Z, um", "p-b": "m:Z"}


def test_a_line_of_many_values_goes_through_its_peaks_in_the_order_of_their_places() -> None:
    """Falling and rising ones: each column has its largest and smallest value as they came."""
    places = np.arange(4000.0)
    for values in (places, -places, np.where(places == 1234.0, 9.0, np.sin(places / 50.0))):
        found = _reduced(places, values)
        assert 400 <= len(found) <= 800
        shown = [place for place, _ in found]
        assert shown == sorted(shown)
        assert all(value == values[int(place)] for place, value in found)
        kept = [value for _, value in found]
        assert (min(kept), max(kept)) == (values.min(), values.max())


@pytest.mark.parametrize("turn", [1, -1])
def test_a_picture_of_two_lines_is_as_wide_as_both_whichever_begins_first(turn: int) -> None:
    """5 to 10 inside 0 to 20: the longer line goes from edge to edge."""
    short, long = ("short", line([5, 10], [0, 1])), ("long", line([0, 20], [0, 1]))
    found = polylines(overlay("s", dict([short, long][::turn]), ("0", "20")))
    inner, outer = [found[kind] for kind in ("cmp-before", "cmp-after")][::turn]
    (left, _), (right, _) = outer
    assert right == RIGHT_PX
    across = [(x - left) / (right - left) for x, _ in inner]
    assert across == pytest.approx([0.25, 0.5], abs=2e-3)
