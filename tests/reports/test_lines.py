"""Lines of the report: fitted lines of several cases in one picture, from hand-written tables."""

import re
from itertools import pairwise
from pathlib import Path

import pytest

from axisrig.bench.campaign.results.stored import read_results
from axisrig.bench.plan.verdict import Verdict
from axisrig.reports.lines.drawing import HEIGHT, WIDTH, Fitted, Point, drawing
from axisrig.reports.lines.section import lines, lines_section

CASES = "plan,case,run,verdict,sim_s,wall_s,seed,alarms,frame_log_sha256,plc:V.E.FEED,runs"
CHECKS = "plan,case,run,check,metric,value,unit,lower,upper,uncertainty,verdict,reference"
ERROR, VELOCITY = "latch_error_um", "contact_velocity_mm_s"
DELAYS_MS = {"drive": 0.004, "plc": 0.5, "plc-2": 0.5}


def folder(place: Path, side: str, *, is_whole: bool = True) -> Path:
    """Cases with a run at 5, 10 and 20 mm/s towards smaller positions: error -5 - v delay."""
    cases, checks = [CASES], [CHECKS]
    for case, delay_ms in DELAYS_MS.items():
        for speed in (5, 10, 20):
            run = f"p-{case}-{speed}"
            cases.append(f"p,{case},{run},pass,1,1,1,,,{speed * 60},")
            for metric, value in (
                (f"mean({ERROR}; each)", -5 - speed * delay_ms),
                (f"spread({ERROR}; each)", speed * delay_ms / 3),
                (f"mean({VELOCITY}; each)", -speed),
            ):
                checks.append(f"p,{case},{run},<= 99,{metric},{value},um,,99,0.1,pass,p.csv:2")
        cases.append(f"p,{case},p-{case},pass,0,0,,,,,3")
        for name, value in (("slope", delay_ms), ("intercept", -5))[: 2 if is_whole else 1]:
            metric, verdict = f"{name}({ERROR}; {side})", "fail" if case == "plc-2" else "pass"
            checks.append(f"p,{case},p-{case},<= 9,{metric},{value},um,,9,0.1,{verdict},p.csv:2")
    (place / "cases.csv").write_text("\n".join([*cases, ""]), encoding="utf-8")
    (place / "results.csv").write_text("\n".join([*checks, ""]), encoding="utf-8")
    return place


def test_all_cases_of_a_plan_are_in_one_picture(tmp_path: Path) -> None:
    (one,) = lines(read_results(folder(tmp_path, VELOCITY)))
    assert (one.plan, one.metric, one.column) == ("p", ERROR, VELOCITY)
    assert [fitted.name for fitted in one.fitted] == list(DELAYS_MS)
    for fitted in one.fitted:
        delay_ms = DELAYS_MS[fitted.name]
        assert [(point.x, point.y) for point in fitted.points] == [
            (-v, pytest.approx(-5 - v * delay_ms)) for v in (5, 10, 20)
        ]
        assert [point.spread for point in fitted.points] == pytest.approx(
            [v * delay_ms / 3 for v in (5, 10, 20)]
        )
    text = lines_section(read_results(tmp_path))
    assert text.count("<svg") == 1
    assert text.count('class="ln-line"') == 3
    assert "plc-2 ✖ fail" in text  # not by colour alone
    assert text.count("<tr>") == 4


def test_a_line_over_an_input_has_its_points_at_the_input(tmp_path: Path) -> None:
    (one,) = lines(read_results(folder(tmp_path, "plc:V.E.FEED")))
    assert [point.x for point in one.fitted[0].points] == [300, 600, 1200]


def test_a_slope_alone_is_no_line(tmp_path: Path) -> None:
    assert lines_section(read_results(folder(tmp_path, VELOCITY, is_whole=False))) == ""


def test_points_are_where_their_values_are_and_names_do_not_cover_each_other() -> None:
    points = tuple(Point(f"r{v}", -v, -5 - 0.5 * v, None, Verdict.PASS) for v in (5.0, 10.0, 20.0))
    fitted = [Fitted(f"<{n}>", 0.5, -5.0, points, Verdict.PASS) for n in range(10)]
    text = drawing(fitted, "e over v", "e", "v")
    names = re.findall(r'class="ln-name" x="[\d.]+" y="([\d.]+)"', text)
    heights = sorted(float(height) for height in names)
    assert len(heights) == 10
    assert min(b - a for a, b in pairwise(heights)) >= 13.9
    assert 0 < heights[0] < heights[-1] < HEIGHT
    assert "&lt;1&gt;" in text
    assert "<1>" not in text
    (alone,) = [drawing(fitted[:1], "e over v", "e", "v")]
    begin = re.search(r'class="ln-line" d="M([\d.]+),([\d.]+)L([\d.]+),([\d.]+)"', alone)
    assert begin is not None
    x0, y0, x1, y1 = map(float, begin.groups())
    found = re.findall(r"<title>r.*?M([\d.]+),([\d.]+)m", alone)
    for x, y in [tuple(map(float, place)) for place in found]:
        assert x0 < x <= x1 < WIDTH  # larger speeds are farther right, though they are negative
        assert y == pytest.approx(y0 + (y1 - y0) * (x - x0) / (x1 - x0), abs=0.2)
