"""Where a timeline puts instants: shares of its width, in the order and size of the times."""

import re

import pytest

from axisrig.reports.fixed_stop.timeline import Row, Span, axis, lane, span_of

SPAN = Span(100.0, 300.0)


@pytest.mark.parametrize(
    ("time_ms", "x"),
    [(100.0, 1.2), (150.0, 25.0), (200.0, 50.0), (290.0, 95.0), (300.0, 98.8), (0.0, 1.2),
     (900.0, 98.8), (102.0, 1.2), (298.0, 98.8)],
)  # fmt: skip
def test_an_instant_is_a_share_of_the_width_and_stays_on_it(time_ms: float, x: float) -> None:
    assert SPAN.x(time_ms) == pytest.approx(x)


@pytest.mark.parametrize(
    ("low", "high", "ticks"),
    [
        (100.0, 300.0, [100, 150, 200, 250, 300]),
        (0.0, 4.0, [0, 1, 2, 3, 4]),
        (-1.0, 7.1, [0, 2, 4, 6]),
        (-1.0, 6.9, [-1, 0, 1, 2, 3, 4, 5, 6]),
        (0.0, 0.02, [0, 0.005, 0.01, 0.015, 0.02]),
        (1.0, 81.0, [20, 40, 60, 80]),
    ],
)
def test_ticks_are_round_and_four_to_ten(low: float, high: float, ticks: list[float]) -> None:
    assert Span(low, high).ticks() == pytest.approx(ticks)


def test_a_span_has_room_around_what_it_shows() -> None:
    """A tenth before the first and less behind the last; of one instant a micro-second."""
    found = span_of([20.0, 10.0, 30.0])
    assert (found.low, found.high) == pytest.approx((8.0, 30.6))
    alone = span_of([5.0])
    assert (alone.low, alone.high) == pytest.approx((4.999, 5.0003))


def test_the_grid_is_where_the_ticks_are_and_zero_is_another_line() -> None:
    text = axis(Span(-100.0, 300.0), 'a "name"')
    lines = re.findall(r'class="(tl-\w+)" x1="([\d.]+)%" x2="([\d.]+)%"', text)
    assert [(kind, x1) for kind, x1, _ in lines] == [
        ("tl-grid", "1.20"), ("tl-zero", "25.00"), ("tl-grid", "50.00"), ("tl-grid", "75.00"),
        ("tl-grid", "98.80"),
    ]  # fmt: skip
    assert all(x1 == x2 for _, x1, x2 in lines)
    assert re.findall(r"<text [^>]*>([^<]*)<", text) == ["-100", "0", "100", "200", "300"]
    assert '<g id="a &quot;name&quot;">' in text


def drawn(**row: object) -> str:
    return lane(SPAN, Row(**{"kind": "brake", "at": None, "label": "a <row>", **row}), "grid")  # type: ignore[arg-type]


BAND = r'class="tl-band" x="([\d.]+)%" y="2" width="([\d.]+)%"'
FORM = r'class="tl-form" x1="([\d.]+)%" x2="([\d.]+)%"'
STRETCH = r'class="tl-stretch k-brake" x="([\d.]+)%" y="8" width="([\d.]+)%"'


def test_a_row_has_its_band_stretch_and_mark_at_their_times() -> None:
    text = drawn(at=200.0, band=(150.0, 200.0, 250.0), stretch=(150.0, 200.0))
    assert re.findall(BAND, text) == [("25.00", "50.00")]
    assert re.findall(FORM, text) == [("50.00", "50.00")]
    assert re.findall(STRETCH, text) == [("25.00", "25.00")]
    assert 'class="tl-mark k-brake" x1="50.00%" x2="50.00%"' in text
    assert 'aria-label="a &lt;row&gt;"' in text
    assert '<use href="#grid"/>' in text
    plain = drawn()
    for part in ("tl-band", "tl-stretch", "tl-mark", "tl-arrow"):
        assert part not in plain


@pytest.mark.parametrize(
    ("band", "is_shown"),
    [
        ((50.0, 80.0, 99.0), False),
        ((50.0, 80.0, 100.0), True),  # its end is on the drawing
        ((300.0, 310.0, 320.0), True),
        ((301.0, 310.0, 320.0), False),
        ((50.0, 200.0, 400.0), True),
    ],
)
def test_a_band_is_drawn_where_any_of_it_is_on_the_drawing(
    band: tuple[float, float, float], is_shown: bool
) -> None:
    assert ("tl-band" in drawn(band=band)) is is_shown


def test_a_stretch_that_ends_before_it_begins_has_no_width() -> None:
    assert re.findall(STRETCH, drawn(stretch=(200.0, 150.0))) == [("50.00", "0.00")]


@pytest.mark.parametrize(
    ("at", "place", "tip"),
    [(99.9, "0%", "◀"), (300.1, "99%", "▶"), (100.0, "", ""), (300.0, "", "")],
)
def test_what_is_outside_has_an_arrow_to_its_side(at: float, place: str, tip: str) -> None:
    found = re.findall(r'class="tl-arrow k-brake" x="([\d%]+)" y="15">(.)<', drawn(at=at))
    assert found == ([(place, tip)] if tip else [])
