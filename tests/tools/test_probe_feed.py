"""What `axisrig probe-feed` prints."""

import math

import pytest
from typer.testing import CliRunner

from axisrig.bench.cli.main import app
from axisrig.bench.tools.probe_feed import Question, probe_feed_text
from axisrig.kernel.errors import UserError


def test_the_published_example() -> None:
    """12.6 mm at 6000 mm/min with a reaction of 16 ms; shares 1.6, 5 and 6 mm."""
    lines = probe_feed_text(Question(12.6, 16.0, 1.0, 1.0)).splitlines()
    assert lines[1].split() == ["16", "6000.0", "1.6000", "5.0000", "0.0000", "6.0000", "12.6000"]
    assert lines[2].split()[0] == "32"
    assert lines[2].split()[-1] == "12.6000"


def test_the_path_of_a_feed() -> None:
    (one, two) = probe_feed_text(Question(5.0, 8.0, 1.0, 1.0), 6000.0).splitlines()[1:3]
    assert one.split()[-1] == "11.8000"
    assert two.split()[-1] == "12.6000"


@pytest.mark.parametrize("feed_mm_min", [None, 60.0, 6000.0, 90000.0])
def test_what_is_within_the_stroke_does_not_depend_on_the_feed_that_is_asked(
    feed_mm_min: float | None,
) -> None:
    """v t + v^2/2b + v/Kv = 12.6 mm: 100 mm/s at 16 ms; 86.06 mm/s at 32 ms (Kv 1000/60 per s)."""
    last = probe_feed_text(Question(12.6, 16.0, 1.0, 1.0), feed_mm_min).splitlines()[-1]
    largest = [60.0 * largest_mm_s(12.6, t_s, 1000.0, 1000.0 / 60.0) for t_s in (0.016, 0.032)]
    assert largest[0] == pytest.approx(6000.0)
    assert last == (
        f"Within a stroke of 12.6 mm: at most {largest[1]:.1f} mm/min for every edge,"
        f" {largest[0]:.1f} mm/min if it always took one cycle."
    )


def largest_mm_s(way_mm: float, reaction_s: float, b_mm_s2: float, kv_per_s: float) -> float:
    """The positive root of v^2/2b + (t + 1/Kv) v - s."""
    p = b_mm_s2 * (reaction_s + 1.0 / kv_per_s)
    return math.sqrt(p * p + 2.0 * b_mm_s2 * way_mm) - p


@pytest.mark.parametrize(
    ("option", "value", "allowed"),
    [
        ("--stroke", "0", "above 0"),
        ("--decel", "-1", "above 0"),
        ("--kv", "nan", "above 0"),
        ("--cycle", "-1", "0 or more"),
        ("--feed-forward", "1.5", "0 to 1"),
        ("--feed", "0", "above 0, mm/min"),
    ],
)
def test_a_number_that_no_machine_has(option: str, value: str, allowed: str) -> None:
    given = {"--stroke": "5", "--decel": "1", "--kv": "1", "--cycle": "8", option: value}
    words = [word for pair in given.items() for word in pair]
    result = CliRunner().invoke(app, ["probe-feed", *words])
    assert result.exit_code == 2
    assert option in result.output
    assert allowed in result.output
    assert "Traceback" not in result.output


def test_errors_name_the_value() -> None:
    with pytest.raises(UserError, match="--ramp"):
        Question(5.0, 8.0, 1.0, 1.0, ramp_ms=-3.0)


def test_every_option_has_its_share() -> None:
    """50 mm/s: 4 ms and one or two cycles of 8 ms, v^2/2b, v t_r/2, three quarters of v/Kv."""
    given = Question(
        2.625, 8.0, 2.0, 3.0, delay_ms=4.0, ramp_ms=10.0, feed_forward=0.25
    )  # Kv 3 (m/min)/mm are 50/s
    lines = probe_feed_text(given, 3000.0).splitlines()
    shares = ["0.6250", "0.2500", "0.7500"]
    assert lines[1].split() == ["12", "3000.0", "0.6000", *shares, "2.2250"]
    assert lines[2].split() == ["20", "3000.0", "1.0000", *shares, "2.6250"]
    largest = probe_feed_text(given).splitlines()
    assert largest[2].split() == lines[2].split()
    assert float(largest[1].split()[1]) > 3000.0
    assert largest[-1].startswith("Within a stroke of 2.625 mm: at most 3000.0 mm/min for every")
    assert "cycle of 8 ms" in largest[-2]
