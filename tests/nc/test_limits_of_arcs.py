"""How exact the words of an arc have to be, and what an alarm shows of those that are not.

P-CHAN-00059, 00060 (way of a centre that is corrected), 00171, 00172 (difference of the radii).
"""

import math

import pytest

from axisrig.kernel.nc.coordinates import CircleWords, GeometryError
from axisrig.kernel.nc.coordinates.circle import CircleLimits, plane_arc


def refused(start, end, words):
    with pytest.raises(GeometryError) as caught:
        plane_arc(start, end, words)
    return caught.value.alarm_id, caught.value.values


def as_it_is(clockwise, centre, **limits):
    return CircleWords(clockwise, centre, corrected=False, limits=CircleLimits(**limits))


# ---- G164: both radii are compared

RADII = [
    # start and end from the centre (3, 0), limits, what is refused: difference, limit
    (2.0, 2.0021, {}, ("0.0021", "0.0020")),  # a thousandth of the radius of the start
    (2.0021, 2.0, {}, ("0.0021", "0.0020")),
    (2.0, 1.9979, {}, ("0.0021", "0.0020")),
    (2.0, 2.002001, {}, ("0.0020", "0.0020")),
    (2.002001, 2.0, {}, None),  # 0.002002 are allowed to it
    (2.0, 2.0019, {}, None),
    (2.0, 1.9981, {}, None),
    (50.0, 50.0051, {}, ("0.0051", "0.0050")),  # 0.005 mm is less than 0.05
    (50.0, 49.9949, {}, ("0.0051", "0.0050")),
    (50.0, 50.0049, {}, None),
    (50.0, 50.009, {"radius_mm": 0.01}, None),
    (50.0, 50.011, {"radius_mm": 0.01}, ("0.0110", "0.0100")),
    (2.0, 2.015, {"radius_mm": 0.02, "radius_of_radius": 0.01}, None),
    (2.0, 2.021, {"radius_mm": 0.03, "radius_of_radius": 0.01}, ("0.0210", "0.0200")),
]


@pytest.mark.parametrize(("first", "last", "limits", "shown"), RADII)
@pytest.mark.parametrize("clockwise", [True, False])
def test_radii_that_differ_by_more_than_the_smaller_limit(clockwise, first, last, limits, shown):
    start, end = (3.0 + first, 0.0), (3.0, last)
    words = as_it_is(clockwise, (3.0, 0.0), **limits)
    if shown is None:
        arc = plane_arc(start, end, words)
        assert arc.centre == (3.0, 0.0)  # as it is
        assert math.degrees(arc.angle_rad) == pytest.approx(-270 if clockwise else 90)
        return
    alarm_id, values = refused(start, end, words)
    assert alarm_id == 21758
    assert (values["difference_mm"], values["limit_mm"]) == shown
    assert (values["start_mm"], values["end_mm"]) == (f"{first:.4f}", f"{last:.4f}")


@pytest.mark.parametrize("further_mm", [0.004, -0.004])
def test_an_end_on_the_ray_of_the_start_is_a_full_turn(further_mm):
    """G164: nothing is between them but a part of a radius, either way round."""
    for clockwise, angle_rad in ((True, -math.tau), (False, math.tau)):
        arc = plane_arc((10, 0), (10 + further_mm, 0), as_it_is(clockwise, (0.0, 0.0)))
        assert arc.angle_rad == angle_rad


# ---- G165: the centre is moved

WAYS = [
    # of a centre between (0, 0) and (20, 0): half a circle of radius 10, 0.5 mm
    (20.0, 0.0, 0.51, {}, ("0.5100", "0.5000")),
    (20.0, 0.0, -0.51, {}, ("0.5100", "0.5000")),
    (20.0, 0.0, 0.49, {}, None),
    (20.0, 0.0, -0.49, {}, None),
    (200.0, 0.0, 2.01, {}, ("2.0100", "2.0000")),  # 2 mm is less than 5
    (200.0, 0.0, -1.99, {}, None),
    # 5 mm beside a chord of 24 mm: radius 13
    (24.0, 5.0, 0.66, {}, ("0.6600", "0.6500")),
    (24.0, -5.0, -0.66, {}, ("0.6600", "0.6500")),
    (24.0, 5.0, 0.64, {}, None),
    (20.0, 0.0, 0.9, {"centre_of_radius": 0.1}, None),
    (20.0, 0.0, 0.3, {"centre_mm": 0.25}, ("0.3000", "0.2500")),
]


@pytest.mark.parametrize(("chord", "beside", "off", "limits", "shown"), WAYS)
def test_a_centre_that_would_have_to_move_too_far(chord, beside, off, limits, shown):
    words = CircleWords(False, (chord / 2 + off, beside), limits=CircleLimits(**limits))
    if shown is None:
        arc = plane_arc((0, 0), (chord, 0), words)
        assert arc.centre == pytest.approx((chord / 2, beside))
        return
    alarm_id, values = refused((0, 0), (chord, 0), words)
    assert (alarm_id, values) == (900150, {"offset_mm": shown[0], "limit_mm": shown[1]})


# ---- a radius


@pytest.mark.parametrize("sign", [1, -1])
def test_a_radius_that_does_not_reach_shows_both_lengths(sign):
    words = CircleWords(True, radius_mm=sign * 4.0)
    values = {"radius_mm": "4.0000", "distance_mm": "10.0000"}
    assert refused((1, 1), (9, 7), words) == (900151, values)


@pytest.mark.parametrize("sign", [1, -1])
def test_a_radius_may_be_five_thousandths_of_a_millimetre_too_short(sign):
    """That is rounding: half a circle about the middle, whatever the sign."""
    arc = plane_arc((0, 0), (20, 0), CircleWords(False, radius_mm=sign * 9.9951))
    assert arc.centre == pytest.approx((10, 0))
    assert arc.radius_mm == pytest.approx(10)
    alarm_id, values = refused((0, 0), (20, 0), CircleWords(False, radius_mm=sign * 9.9949))
    assert (alarm_id, values["radius_mm"]) == (900151, "9.9949")


@pytest.mark.parametrize(
    ("start", "end", "words", "alarm_id"),
    [
        ((1, 2), (5, 2), CircleWords(True, (1, 2)), 20036),
        ((1, 2), (1, 2), CircleWords(True, (1, 2)), 20036),  # a full circle of no radius
        ((1, 2), (5, 2), as_it_is(True, (1.0, 2.0)), 20036),
        ((1, 2), (5, 2), as_it_is(True, (5.0, 2.0)), 21758),  # the end in the centre
        ((1, 2), (1, 2), CircleWords(True, radius_mm=5), 20034),
        ((1, 2), (1, 2), CircleWords(True), 20036),
    ],
)
def test_points_that_leave_no_circle(start, end, words, alarm_id):
    assert refused(start, end, words)[0] == alarm_id


@pytest.mark.parametrize("corrected", [True, False])
def test_a_full_circle_has_no_end_to_fit(corrected):
    """Its centre is the one that was programmed, however the limits are."""
    words = CircleWords(True, (4.0, 5.0), corrected=corrected, limits=CircleLimits(0, 0, 0, 0))
    arc = plane_arc((1, 1), (1, 1), words)
    assert (arc.centre, arc.radius_mm, arc.angle_rad) == ((4.0, 5.0), 5.0, -math.tau)
    assert arc.tangent == pytest.approx((-0.8, 0.6))  # radius (-3, -4), turned clockwise


@pytest.mark.parametrize("clockwise", [True, False])
@pytest.mark.parametrize(("off_mm", "is_full"), [(0.0, True), (1e-10, True), (1e-8, False)])
def test_an_end_that_is_the_start_but_for_rounding_is_a_full_circle(
    clockwise: bool, off_mm: float, is_full: bool
) -> None:
    """Beside the start in either direction: 1e-9 mm is the limit, and beyond it is an arc."""
    turn = -math.tau if clockwise else math.tau
    for sign in (1.0, -1.0):
        words = CircleWords(clockwise, (0.0, 0.0))
        angle = plane_arc((5.0, 0.0), (5.0, sign * off_mm), words).angle_rad
        if is_full:
            assert angle == turn
        else:
            way = sign * off_mm / 5.0 % math.tau
            assert angle == pytest.approx(way - math.tau if clockwise else way, abs=1e-12)
