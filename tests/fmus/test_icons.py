"""The icon of a model as it is drawn for an FMU: 64 pixels for 200 units, from its annotation."""

import struct
import zlib
from typing import Any

import pytest
from tests.fmus.test_words_of_models import texts

from axisrig.fmus.writing.icon import SIZE, draw


def pixels(png: bytes) -> list[bytes]:
    """Rows of a PNG with 8 bits of red, green, blue and alpha; checksums are looked at."""
    assert png.startswith(b"\x89PNG\r\n\x1a\n")
    at, body, head = 8, b"", b""
    while at < len(png):
        length, kind = struct.unpack_from(">I4s", png, at)
        content = png[at + 8 : at + 8 + length]
        (check,) = struct.unpack_from(">I", png, at + 8 + length)
        assert check == zlib.crc32(kind + content)
        head, body = (content, body) if kind == b"IHDR" else (head, body + content)
        at += 12 + length
    assert struct.unpack(">IIBBBBB", head) == (SIZE, SIZE, 8, 6, 0, 0, 0)
    raw = zlib.decompress(body)
    rows = [raw[k : k + 4 * SIZE + 1] for k in range(0, len(raw), 4 * SIZE + 1)]
    assert len(rows) == SIZE
    assert {row[0] for row in rows} == {0}
    return [row[1:] for row in rows]


def drawn(*objects: str) -> Any:
    """Colour at a place of the icon, in its units, each part full or nothing; None: not drawn."""
    text = f"model M annotation(Icon(graphics={{{', '.join(objects)}}})); end M;"
    found, _ = texts(text, "M.mo")
    rows = pixels(draw(found, "M"))

    def at(x: float, y: float) -> tuple[int, ...] | None:
        column, row = int((x + 100) * SIZE / 200), int((100 - y) * SIZE / 200)
        red, green, blue, alpha = rows[row][4 * column : 4 * column + 4]
        return None if alpha == 0 else tuple(255 * (each > 127) for each in (red, green, blue))

    return at


FRAME = "{{-80, 40}, {60, -70}}"


@pytest.mark.parametrize("kind", ["Rectangle", "Ellipse"])
def test_a_frame_is_drawn_on_all_its_sides_and_filled_only_where_it_is_solid(kind: str) -> None:
    middle, sides = (-10, -15), [(-80, -15), (60, -15), (-10, 40), (-10, -70)]
    at = drawn(f"{kind}(extent = {FRAME})")
    assert [at(*side) is not None for side in sides] == [True] * 4
    assert (at(*middle), at(-95, -15), at(80, -15)) == (None, None, None)
    filled = f"fillColor = {{255, 0, 0}}, fillPattern = FillPattern.Solid, extent = {FRAME}"
    at = drawn(f"{kind}({filled}, pattern = LinePattern.None)")
    assert at(*middle) == (255, 0, 0)
    assert at(-95, -15) is None
    assert drawn(f"{kind}({filled.replace('Solid', 'None')})")(*middle) is None


@pytest.mark.parametrize(("kind", "is_closed"), [("Polygon", True), ("Line", False)])
def test_the_last_side_of_a_polygon_goes_back_to_its_first_point(
    kind: str, is_closed: bool
) -> None:
    at = drawn(f"{kind}(points = {{{{-60, -60}}, {{60, -60}}, {{60, 60}}}})")
    assert at(0, -60) is not None
    assert at(60, 0) is not None
    assert (at(0, 0) is not None) is is_closed
    assert at(-30, 30) is None


def test_what_comes_later_lies_on_top_and_has_its_own_colour() -> None:
    solid = "fillPattern = FillPattern.Solid, pattern = LinePattern.None"
    at = drawn(
        f"Rectangle(extent = {{{{-80, 80}}, {{20, -80}}}}, fillColor = {{255, 0, 0}}, {solid})",
        f"Rectangle(extent = {{{{-20, 80}}, {{80, -80}}}}, fillColor = {{0, 0, 255}}, {solid})",
        "Line(points = {{-100, 0}, {100, 0}}, color = {0, 255, 0})",
    )
    assert [at(x, 50) for x in (-50, 0, 50)] == [(255, 0, 0), (0, 0, 255), (0, 0, 255)]
    assert at(-50, -50) == (255, 0, 0)


@pytest.mark.parametrize(
    "pattern", ["", ", pattern = LinePattern.Solid", ", pattern = LinePattern.Dash"]
)
def test_a_line_has_its_own_colour_and_is_drawn_whatever_its_pattern(pattern: str) -> None:
    """Modelica 3.6, 18.6: `color` of a line, `lineColor` of a shape; None alone draws nothing."""
    line, frame = "points = {{-100, 0}, {100, 0}}", f"extent = {FRAME}"
    at = drawn(f"Line({line}, color = {{255, 0, 0}}{pattern})")
    assert at(0, 0) == (255, 0, 0)
    at = drawn(f"Line({line}, lineColor = {{255, 0, 0}}{pattern})")
    assert at(0, 0) == (0, 0, 0)
    at = drawn(f"Rectangle({frame}, lineColor = {{0, 0, 255}}{pattern})")
    assert (at(-80, 0), at(0, 0)) == ((0, 0, 255), None)
    at = drawn(f"Rectangle({frame}, color = {{0, 0, 255}}{pattern})")
    assert at(-80, 0) == (0, 0, 0)
    at = drawn(f"Line({line}, pattern = LinePattern.None)", f"Rectangle({frame})")
    assert (at(0, 0), at(-80, 0)) == (None, (0, 0, 0))


def test_a_class_that_draws_nothing_is_a_box() -> None:
    at = drawn()
    assert [at(*place) is not None for place in ((-90, 0), (90, 0), (0, 60), (0, -60))] == [
        True
    ] * 4
    assert at(0, 90) is None


def test_a_base_class_is_drawn_below_what_extends_it_and_its_own_base_lowest() -> None:
    def box(half: int, colour: str) -> str:
        extent = f"{{{{-{half}, {half}}}, {{{half}, -{half}}}}}"
        return (
            f"annotation(Icon(graphics={{Rectangle(extent = {extent}, fillColor = {{{colour}}},"
            " fillPattern = FillPattern.Solid, pattern = LinePattern.None)}));"
        )

    text = f"""
model M
  extends B;
  {box(20, "255, 0, 0")}
end M;
model B
  extends C;
  {box(50, "0, 255, 0")}
end B;
model C
  {box(80, "0, 0, 255")}
end C;
"""
    found, _ = texts(text, "M.mo")
    rows = pixels(draw(found, "M"))
    middle = [rows[SIZE // 2][4 * column : 4 * column + 4] for column in range(SIZE)]
    at = [tuple(middle[int((x + 100) * SIZE / 200)]) for x in (0, 35, 65, 95)]
    assert at[:3] == [(255, 0, 0, 255), (0, 255, 0, 255), (0, 0, 255, 255)]
    assert at[3][3] == 0


def test_a_shape_without_a_colour_is_white_with_a_black_line() -> None:
    solid = "fillPattern = FillPattern.Solid, pattern = LinePattern.None"
    at = drawn(f"Rectangle(extent = {FRAME}, {solid})", "Line(points = {{-90, 80}, {90, 80}})")
    assert at(0, 0) == (255, 255, 255)
    assert [at(x, 80) for x in (-80, 0, 80)] == [(0, 0, 0)] * 3
    assert (at(0, 70), at(0, 90)) == (None, None)
    assert drawn(f"Rectangle(extent = {FRAME})")(-80, 0) == (0, 0, 0)


@pytest.mark.parametrize(
    "empty",
    [
        "Line(points = {})",
        "Line(points = {{1, 2}})",
        "Rectangle(fillColor = {0, 0, 255})",
        "Ellipse(extent = {{5, 5}})",
        "Polygon(points = {{3, 3}}, fillPattern = FillPattern.Solid)",
    ],
)
@pytest.mark.parametrize("is_first", [True, False])
def test_a_shape_without_corners_draws_nothing_and_hides_no_other(
    empty: str, is_first: bool
) -> None:
    other = (
        f"Rectangle(fillColor = {{255, 0, 0}}, fillPattern = FillPattern.Solid, extent = {FRAME})"
    )
    at = drawn(*([empty, other] if is_first else [other, empty]))
    assert at(-10, -15) == (255, 0, 0)
    assert at(90, 90) is None


@pytest.mark.parametrize("turned", [False, True])
def test_a_line_ends_at_its_points(turned: bool) -> None:
    """Half a line is 2 units wide, a pixel 3.1: nothing is drawn 10 units beyond its ends."""
    ends = "{-50, 0}, {10, 0}" if not turned else "{0, -50}, {0, 10}"
    at = drawn(f"Line(points = {{{ends}}})")
    found = [along for along in range(-95, 100, 5) if at(*((0, along) if turned else (along, 0)))]
    assert (found[0], found[-1]) == (-50, 10)
    assert found == list(range(-50, 15, 5))


@pytest.mark.parametrize("kind", ["Line", "Polygon"])
def test_a_line_has_nothing_inside(kind: str) -> None:
    at = drawn(
        f"{kind}(points = {{{{-60, -60}}, {{60, -60}}, {{0, 60}}}}, fillColor = {{255, 0, 0}},"
        " fillPattern = FillPattern.Solid)"
    )
    assert at(0, -20) == ((255, 0, 0) if kind == "Polygon" else None)
    assert at(0, -60) is not None
