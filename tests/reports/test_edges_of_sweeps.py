"""Which sweeps and searches a page draws: in which order, how many, and from how many runs on."""

import re
from itertools import pairwise
from pathlib import Path

import pytest
from tests.reports.test_blocks_of_sweeps import THREE, captions, sample, section, sweep
from tests.reports.test_searches_of_a_page import COLUMN, search
from tests.reports.test_ways_of_failing import check, run, text

from axisrig.bench.campaign.results.stored import StoredResults
from axisrig.bench.plan.check_row import CheckRow
from axisrig.reports.sweeps.drawing import shown
from axisrig.reports.sweeps.searches import search_pictures
from axisrig.reports.sweeps.section import sweeps


def test_metrics_of_a_search_come_by_their_worst_probe() -> None:
    """Not by its last one; a metric without a limit is not drawn."""
    row, *probes = search("p-s", "pass", "fail", "pass")
    words = {"good": ("pass", "pass", "pass"), "middle": ("pass", "inconclusive", "pass"),
             "bad": ("fail", "pass", "pass"), "last": ("pass", "pass", "marginal")}  # fmt: skip
    for place, probe in enumerate(probes):
        probe.__dict__["checks"] = [
            CheckRow(name, value=str(place), upper="1", uncertainty="0", verdict=verdicts[place])
            for name, verdicts in words.items()
        ] + [CheckRow("free", value=str(place), uncertainty="0", verdict="fail")]
    drawn = re.findall(r"<figcaption>(\w+) over", search_pictures(row, probes))
    assert drawn == ["bad", "middle", "last"]
    assert COLUMN in search_pictures(row, probes)


@pytest.mark.parametrize(("columns", "second"), [(49, 0), (48, 0), (47, 1), (3, 1)])
def test_the_first_sweep_is_drawn_however_many_pictures_it_takes(columns: int, second: int) -> None:
    """48 pictures are the room of the section; what has none is counted."""
    names = tuple(f"plc:V.E.A{number}" for number in range(columns))
    many = sweep(*(sample(" ".join([str(n)] * columns), n) for n in range(3)), columns=names)
    one = sweep(*(sample(str(n), n) for n in range(3)), metric="other")
    shown = section(many, one)
    assert shown.count("<figure>") == columns + second
    assert ("1 more metrics over swept inputs are not drawn" in shown) is (second == 0)


def test_further_pictures_of_a_metric_name_their_input_with_its_unit() -> None:
    columns = (THREE[0], "plant:probe.trigger_delay_us", "plant:Z.v_max_mm_s")
    runs = [sample(" ".join([str(n)] * 3), n) for n in (1, 2, 3)]
    assert captions(section(sweep(*runs, columns=columns))) == [
        "p-c: m, um over plc:V.E.A", "over plant:probe.trigger_delay_us in us",
        "over plant:Z.v_max_mm_s in mm/s",
    ]  # fmt: skip


def test_a_metric_that_one_value_of_the_input_has_is_no_sweep() -> None:
    """Three runs with another value each at input 1; at 2 it is a word, at 3 it is missing."""
    runs = [
        run(f"r{n}", check(str(n), metric="all"), check(str(n), metric="one"), at=("1", "1"))
        for n in range(3)
    ]
    runs += [run("r3", check("9", metric="all"), text("OFF"), at=("2", "1")),
             run("r4", check("7", metric="all"), at=("3", "1"))]  # fmt: skip
    found = sweeps(StoredResults(Path(), runs, {}))
    assert [(one.metric, one.columns, len(one.samples)) for one in found] == [
        ("all", ("plc:V.E.A",), 5)
    ]


@pytest.mark.parametrize(("count", "is_one"), [(2, False), (3, True)])
def test_a_sweep_has_three_runs_at_least(count: int, is_one: bool) -> None:
    runs = [run(f"r{n}", check(str(n)), at=(str(n), "1")) for n in range(count)]
    beside = run("s", check("5"), at=("9", "1"), case="d")
    about = run("p-c", check("5"), runs="4")
    assert bool(sweeps(StoredResults(Path(), [*runs, beside, about], {}))) is is_one


@pytest.mark.parametrize(
    ("good", "bad", "drawn"),
    [(500, 0, (300, 0)), (500, 10, (290, 10)), (100, 500, (100, 200)), (400, 400, (100, 200)),
     (0, 500, (0, 200)), (150, 150, (150, 150))],
)  # fmt: skip
def test_of_many_values_those_that_did_not_pass_have_two_thirds_and_the_rest_the_room_left(
    good: int, bad: int, drawn: tuple[int, int]
) -> None:
    """300 at most; both ends of the values among them, in whatever order they ran."""
    passed = [sample("1", float((n * 7) % good)) for n in range(good)]
    failed = [sample("1", float((n * 7) % bad), word="fail") for n in range(bad)]
    found = shown([*failed, *passed])
    for word, count, of in (("pass", drawn[0], good), ("fail", drawn[1], bad)):
        values = [one.value for one in found if one.verdict.word == word]
        assert len(values) == count
        if 0 < count < of:
            assert (values[0], values[-1]) == (0.0, of - 1.0)
            # Evenly: no gap is above what the values and the places make
            assert max(b - a for a, b in pairwise(values)) <= -(-(of - 1) // (count - 1))
            assert values == sorted(set(values))
