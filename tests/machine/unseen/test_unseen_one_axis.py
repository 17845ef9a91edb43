"""Unseen programs with one measuring axis."""

import pytest
from unseen_geometry import A_MM_S2, Run, near, plane, show, starts


@pytest.mark.long
@pytest.mark.parametrize(
    ("axis", "begin", "wall", "feed"),
    [
        ("X", 30.0, 40.0123456, 1200),
        ("X", 0.3, -0.15, 60),
        ("Y", -8.0, -25.000004, 6000),
        ("Y", -120.0, -111.11111, 333.3),
        ("Z", 250.0, 241.7, 4321),
        ("Z", -3.0, 2.7182818, 600),
        ("Z", 3.0, -2.7182818, 600),
    ],
)
def test_any_axis_in_any_direction_at_any_feed(
    run_nc: Run, axis: str, begin: float, wall: float, feed: float
) -> None:
    towards = 1.0 if wall > begin else -1.0
    normal = {a: -towards if a == axis else 0.0 for a in "XYZ"}
    begins = {a: begin if a == axis else 10.0 for a in "XYZ"}
    target = wall + towards * 15
    rig = starts(*begins.values()) + "\n" + plane(normal.values(), -towards * wall)
    out = run_nc(
        f"N10 G100 {axis}{target} F{feed}\n" + show(f"MESS.{axis}", "MERF.X", "MERF.Y", "MERF.Z"),
        rig,
    )
    assert out.alarms == []
    assert out.printed(f"MESS.{axis}") == near([wall])
    for other in "XYZ":
        assert out.printed(f"MERF.{other}") == [float(other == axis)]


@pytest.mark.long
@pytest.mark.parametrize("depth_mm", [1.0, 3.1, 9.0, 16.9, 19.3])
def test_the_edge_may_fall_into_any_part_of_the_motion(run_nc: Run, depth_mm: float) -> None:
    """100 mm/s on 20 mm: speeding up until 5 mm, braking from 15 mm on, 2.5 mm of lag between."""
    wall = 200.0 - depth_mm
    out = run_nc(
        "N10 G100 Z180 F6000\n" + show("MESS.Z"), starts(0, 0, 200) + "\n" + plane((0, 0, 1), wall)
    )
    assert out.printed("MESS.Z") == near([wall])


@pytest.mark.long
@pytest.mark.parametrize("feed", [60, 137, 1234.5, 6000])
def test_the_input_delay_moves_the_value_by_v_times_it(run_nc: Run, feed: float) -> None:
    """probe-z.toml has 4 us; the wall is far enough for steady motion (10 time constants)."""
    v = feed / 60
    wall = 130.0 - v * 0.3 - v * v / (2 * A_MM_S2) - 0.00317
    out = run_nc(
        f"N10 G100 Z{wall - 20} F{feed}\n" + show("MESS.Z"),
        plane((0, 0, 1), wall),
        base="probe-z.toml",
    )
    assert out.printed("MESS.Z") == near([wall - v * 4e-6])


@pytest.mark.long
def test_no_contact_gives_no_value_and_reading_it_is_an_alarm(run_nc: Run) -> None:
    out = run_nc(
        "N10 G100 Z245 F3000\n" + show("MERF.Z") + "\nN30 " + show("MESS.Z"), plane((0, 0, 1), 200)
    )
    assert out.lines == ["MERF.Z=0.000000"]
    assert out.alarms == [900101]
