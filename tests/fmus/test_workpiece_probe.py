"""The probe on workpieces against closed forms: instants, bounce, radio, switching on."""

import math

import pytest
from fmpy.fmi1 import FMICallException

LOCATED = 1e-9  # s
STEPS = [0.1e-3, 1e-3, 2.5e-3, 10e-3, 100e-3]


def line(t, size, **motion):
    """The inputs of a step of straight motion; motion: x=(position at 0, rate) and so on."""
    values = {"step_time": t, "step_size": size}
    for name, (p0, v) in motion.items():
        values |= {f"{name}_start": p0 + v * t, f"{name}_end": p0 + v * (t + size)}
        values |= {f"{name}_rate_start": v, f"{name}_rate_end": v}
    return values


@pytest.fixture
def touch(load):
    """Runs the probe along a straight motion in equal steps, with start values."""

    def run(until, size=1e-3, motion=None, **start):
        motion = motion or {"z": (0.02, -0.05)}
        fmu = load("AxisRig.Sensors.WorkpieceProbe", **start, **line(0.0, size, **motion))
        for k in range(round(until / size)):
            fmu.set(**line(k * size, size, **motion))
            fmu.step_to((k + 1) * size)
        return fmu

    return run


@pytest.mark.parametrize("size", STEPS)
def test_edge_does_not_depend_on_the_step(touch, size):
    """20 mm above at 50 mm/s, a ball of 3 mm: contact after 17/50 s."""
    fmu = touch(0.6, size, ball_radius=0.003, pretravel=10e-6, trigger_delay=1e-3)
    assert fmu.contact_time == pytest.approx(0.34, abs=LOCATED)
    assert fmu.rising_time == pytest.approx(0.34 + 10e-6 / 0.05 + 1e-3, abs=LOCATED)
    assert (fmu.rising_count, fmu.falling_count, fmu.contact_count) == (1, 0, 1)


@pytest.mark.parametrize("degrees", [0, 15, 30, 45, 60])
def test_ball_meets_an_inclined_plane_early(touch, degrees):
    """Lowered on a plane inclined by b, the lowest point is r (1/cos b - 1) above it."""
    b, r = math.radians(degrees), 0.003
    start = {"ball_radius": r, "workpiece.inclined.angle": b}
    fmu = touch(0.4, **start)
    assert fmu.contact_z - r == pytest.approx(r * (1 / math.cos(b) - 1), abs=1e-10)


@pytest.mark.parametrize("across", [-0.011, -0.004, 0.0, 0.007])
def test_ball_on_a_cylinder_is_a_larger_circle(touch, across):
    """The centre of the ball touches at the circle of radius R + r; R = 50 mm, r = 1 mm."""
    start = {"ball_radius": 1e-3, "workpiece.cylinder.radius": 0.05}
    fmu = touch(0.6, motion={"x": (across, 0.0), "z": (0.02, -0.05)}, **start)
    circle = math.sqrt(0.051**2 - across**2) - 0.05
    assert fmu.contact_z == pytest.approx(circle, abs=1e-9)


def test_hole_is_measured_from_inside(touch):
    """Bore of 40 mm, ball of 6 mm: contact 17 mm from its axis."""
    start = {"ball_radius": 0.003, "workpiece.hole.radius": 0.02, "workpiece.hole.center_x": 0.1}
    motion = {"x": (0.1, 0.05), "z": (-0.01, 0.0)}
    fmu = touch(0.5, motion=motion, **start)
    assert fmu.contact_x == pytest.approx(0.117, abs=1e-10)


def test_corner_of_an_edge_is_touched_by_the_side_of_the_ball(touch):
    """Centre 2 mm beyond the edge: a ball of 3 mm comes down to sqrt(5) mm above the top."""
    start = {"ball_radius": 0.003, "workpiece.border.position": 0.01}
    fmu = touch(0.6, motion={"x": (0.012, 0.0), "z": (0.02, -0.05)}, **start)
    assert fmu.contact_z == pytest.approx(math.sqrt(5) * 1e-3, abs=1e-10)
    past = touch(0.6, motion={"x": (0.0131, 0.0), "z": (0.02, -0.05)}, **start)
    assert past.contact_count == 0


def test_bounces_keep_their_number_and_instants(touch):
    """Three openings within 1.2 ms: edges every 0.2 ms, the last one closes."""
    fmu = touch(0.6, bounce_count=3, bounce_time=1.2e-3)
    assert (fmu.rising_count, fmu.falling_count, fmu.contact_count) == (4, 3, 1)
    assert fmu.rising_time == pytest.approx(0.4 + 1.2e-3, abs=LOCATED)
    assert fmu.falling_time == pytest.approx(0.4 + 1.0e-3, abs=LOCATED)


def test_radio_deviation_repeats_with_the_seed(touch):
    """10 ms and at most 1 ms to either side; another seed, another deviation."""
    found = [
        touch(0.6, radio_delay=10e-3, radio_jitter=1e-3, seed=seed).rising_time
        for seed in (1, 1, 2, 3, 4)
    ]
    assert found[0] == found[1]
    assert len(set(found[1:])) == 4
    assert all(0.409 <= t <= 0.411 for t in found)


def test_probe_tells_nothing_until_it_is_ready(load):
    """Touched all the time, switched on at 0.5 s, ready 0.25 s later: that is the edge."""
    start = {"z_start": -1e-3, "z_end": -1e-3, "switch_on_time": 0.25, "switched_on": False}
    fmu = load("AxisRig.Sensors.WorkpieceProbe", **start)
    fmu.step_to(0.5)
    assert (fmu.signal, fmu.ready, fmu.contact) == (False, False, True)
    fmu.set(switched_on=True)
    fmu.step_to(0.7)
    assert (fmu.signal, fmu.clearance) == (False, 0.0)
    fmu.step_to(1.0)
    assert (fmu.signal, fmu.rising_count) == (True, 1)
    assert fmu.rising_time == pytest.approx(0.75, abs=LOCATED)
    fmu.set(switched_on=False)
    fmu.step_to(1.1)
    assert (fmu.signal, fmu.ready) == (False, False)


@pytest.mark.parametrize(
    "start",
    [
        {"workpiece.inclined.angle": 0.6},
        {"workpiece.step.rise": 2.8e-3, "workpiece.step.flank": 5e-3},
        {"workpiece.sine.amplitude": 1e-3, "workpiece.sine.wavelength": 0.03},
        {"workpiece.cylinder.radius": 0.02},
        {
            "workpiece.ramp.rise": -4e-3,
            "workpiece.ramp.length": 0.01,
            "workpiece.inclined.angle": 0.4,
        },
        {"workpiece.step.rise": -2.8e-3, "workpiece.inclined.angle": 0.5},
        {"workpiece.inclined.angle": -0.6, "workpiece.sine.amplitude": 1e-3},
        {"workpiece.sine.amplitude": -4e-3, "workpiece.inclined.angle": 0.25},
        {"workpiece.waviness.amplitude": [1e-3, -3e-3, 0.0, 0.0]},
        {"workpiece.border.position": 2e-3},
        {"workpiece.hole.radius": 8e-3},
    ],
    ids=lambda start: next(iter(start)),
)
def test_no_touch_lies_within_the_clearance(load, start):
    """Moved by just less than the clearance in any direction, the ball does not touch."""
    fmu = load("AxisRig.Sensors.WorkpieceProbe")
    for x, z in ((-0.012, 0.012), (-0.003, 0.008), (0.0, 0.006), (0.004, 0.007), (0.011, 0.015)):
        at = {"x_start": x, "x_end": x, "z_start": z, "z_end": z, "ball_radius": 1e-3, **start}
        fmu.restart(**at)
        free = 0.999 * fmu.clearance
        if fmu.contact:
            continue
        for k in range(24):
            u, w = x + free * math.cos(k * math.pi / 12), z + free * math.sin(k * math.pi / 12)
            fmu.restart(**{**at, "x_start": u, "x_end": u, "z_start": w, "z_end": w})
            assert not fmu.contact


def test_too_many_touches_under_way_are_an_error_with_their_place(load):
    up, down = ({"z_start": z, "z_end": z} for z in (0.01, -0.01))
    fmu = load("AxisRig.Sensors.WorkpieceProbe", radio_delay=0.1, **up)
    for inputs in (down, up) * 4:
        fmu.set(step_time=fmu.time, step_size=1e-3, **inputs)
        fmu.step(1e-3)
    fmu.set(step_time=fmu.time, step_size=1e-3, **down)
    with pytest.raises(FMICallException):
        fmu.step(1e-3)
    assert "more than four edges" in fmu.messages[-1]


def touched(fmu, count):
    """Ticks of 1 ms at 0.1 m/s: `count` times down into the workpiece and back; pre-travels."""
    found = []
    for k in range(count):
        for away, v in ((1e-3, -0.1), (-1e-3, 0.1)):
            at = 20 * 2 * k + (0 if v < 0 else 20)
            for i in range(20):
                start, t = away + v * 1e-3 * i, (at + i) * 1e-3
                moved = {"z_start": start, "z_end": start + v * 1e-3}
                fmu.set(step_time=t, step_size=1e-3, z_rate_start=v, z_rate_end=v, **moved)
                fmu.step_to(t + 1e-3)
        found.append((fmu.rising_time - fmu.contact_time) * 0.1)
    return found


def test_pretravel_differs_from_touch_to_touch_by_scatter_first_touch_and_drift(load):
    """The same seed and no scatter: what is left is the first touch and the drift."""
    start = {"pretravel": 20e-6, "first_touch": 10e-6, "drift": 2e-6, "seed": 3}
    plain = touched(load("AxisRig.Sensors.WorkpieceProbe", z_start=1e-3, **start), 4)
    assert plain == pytest.approx([30e-6, 22e-6, 24e-6, 26e-6], abs=1e-10)
    drawn = touched(
        load("AxisRig.Sensors.WorkpieceProbe", z_start=1e-3, pretravel_scatter=3e-6, **start), 4
    )
    assert len({round(a - b, 9) for a, b in zip(drawn, plain, strict=True)}) == 4
    other = {**start, "seed": 4}
    again = touched(
        load("AxisRig.Sensors.WorkpieceProbe", z_start=1e-3, pretravel_scatter=3e-6, **other), 4
    )
    assert set(drawn).isdisjoint(again)


def test_a_touch_never_switches_before_its_contact(load):
    """A scatter of many times the pre-travel: the edge is at the contact at the earliest."""
    start = {"pretravel": 1e-6, "pretravel_scatter": 50e-6, "z_start": 1e-3}
    found = touched(load("AxisRig.Sensors.WorkpieceProbe", **start), 8)
    assert min(found) == pytest.approx(0.0, abs=1e-10)
    assert max(found) > 10e-6
