"""The capacitive distance sensor against closed forms: tilt, loss, touch, filter, noise."""

import math
import statistics

import pytest

SENSOR = "AxisRig.Sensors.DistanceSensor"


@pytest.fixture
def resting(load):
    """A sensor that rests above the workpiece."""

    def rest(x=0.0, y=0.0, z=2e-3, until=None, **start):
        at = {
            f"{g}_{end}": p for g, p in (("x", x), ("y", y), ("z", z)) for end in ("start", "end")
        }
        fmu = load(SENSOR, **at, **start)
        if until:
            fmu.step_to(until)
        return fmu

    return rest


def test_plane_is_told_as_it_is_from_the_first_instant(resting):
    fmu = resting(z=2e-3, **{"workpiece.plane.level": 0.5e-3})
    assert fmu.distance == pytest.approx(1.5e-3, rel=1e-12)
    assert (fmu.valid, fmu.touching) == (True, False)


@pytest.mark.parametrize(("d", "theta"), [(0.75e-3, 0.03), (2e-3, 0.1), (2e-3, 0.2)])
def test_tilt_error_is_that_of_a_disc(resting, d, theta):
    """An ideal disc tells d (1 + sqrt(1 - (r tan b/d)^2))/2; exact to 1e-5 of the error here."""
    fmu = resting(z=d, electrode_radius=2e-3, **{"workpiece.inclined.angle": theta})
    q = (2e-3 * math.tan(theta) / d) ** 2
    assert fmu.distance == pytest.approx(d * (1 + math.sqrt(1 - q)) / 2, rel=1e-5)


def test_tilt_error_of_the_published_example(resting):
    """13 um at r 3 mm, d 0.75 mm, 0.03 rad with the factor 5 (Lion Precision, probe tilt)."""
    fmu = resting(
        z=0.75e-3, electrode_radius=3e-3, tilt_factor=5.0, **{"workpiece.inclined.angle": 0.03}
    )
    assert 0.75e-3 - fmu.distance == pytest.approx(13e-6, abs=0.6e-6)


@pytest.mark.parametrize(("beyond", "share"), [(-2e-3, 1.0), (0.0, 0.5), (1e-3, 0.1955011)])
def test_capacitance_falls_with_the_covered_share_at_an_edge(resting, beyond, share):
    """Half the disc covered: twice the distance. The segment beyond r/2 is 0.1955 of the disc."""
    fmu = resting(x=0.05 + beyond, z=1e-3, **{"workpiece.border.position": 0.05})
    assert fmu.distance == pytest.approx(1e-3 / share, rel=1e-6)
    assert fmu.valid is True


@pytest.mark.parametrize(
    "lost", [{"workpiece.border.position": -3e-3}, {"workpiece.hole.radius": 3e-3}]
)
def test_loss_runs_to_full_scale_and_is_not_valid(resting, lost):
    fmu = resting(z=1e-3, residual=0.02, until=0.05, **lost)
    assert fmu.distance == pytest.approx(0.01, rel=1e-9)
    assert (fmu.valid, fmu.touching) == (False, False)


def test_hole_smaller_than_the_electrode_takes_its_share(resting):
    """A hole of 1 mm below a disc of 2 mm leaves three quarters."""
    fmu = resting(z=1e-3, **{"workpiece.hole.radius": 1e-3})
    assert fmu.distance == pytest.approx(1e-3 / 0.75, rel=1e-9)


@pytest.mark.parametrize("size", [0.1e-3, 1e-3, 10e-3])
def test_touch_is_located_and_told_as_zero(load, size):
    """5 mm above at 50 mm/s."""
    fmu = load(SENSOR, z_start=5e-3, z_end=5e-3 - 0.05 * size, noise=1e-5)
    for k in range(round(0.12 / size)):
        z = 5e-3 - 0.05 * k * size
        fmu.set(step_time=k * size, step_size=size, z_start=z, z_end=z - 0.05 * size)
        fmu.set(z_rate_start=-0.05, z_rate_end=-0.05)
        fmu.step_to((k + 1) * size)
    assert fmu.touch_time == pytest.approx(0.1, abs=1e-9)
    assert (fmu.touching, fmu.valid, fmu.touch_count, fmu.distance) == (True, True, 1, 0.0)


@pytest.mark.parametrize(("order", "lag"), [(1, 1.0), (2, 2 * 0.7)])
def test_steady_motion_lags_by_the_time_of_the_filter(load, order, lag):
    """v/w for the first order, 2 D v/w for the second one."""
    fmu = load(SENSOR, order=order, z_start=2e-3, z_end=8e-3, step_size=0.1)
    fmu.set(z_rate_start=0.06, z_rate_end=0.06)
    fmu.step_to(0.05)
    behind = fmu.distance_true - fmu.distance
    assert behind == pytest.approx(0.06 * lag / (2 * math.pi * 1000), rel=1e-4)


def noise(fmu, count):
    """Deviations from the true distance at `count` instants, one for each random number."""
    found = []
    for k in range(count):
        fmu.step_to((k + 1.5) * 1e-4)
        found.append(fmu.distance - fmu.distance_true)
    return found


def test_noise_repeats_with_its_seed_and_grows_with_the_square(resting):
    at = {"noise": 2e-6, "noise_distance": 1e-3, "seed": 8}
    near, again = noise(resting(z=1e-3, **at), 2000), noise(resting(z=1e-3, **at), 2000)
    assert near == again
    assert noise(resting(z=1e-3, **(at | {"seed": 9})), 20) != near[:20]
    assert statistics.stdev(near) == pytest.approx(2e-6, rel=0.06)
    assert abs(statistics.mean(near)) < 4 * 2e-6 / math.sqrt(2000)
    pairs = statistics.correlation(near[:-1], near[1:])
    assert abs(pairs) < 4 / math.sqrt(2000)
    far = noise(resting(z=2e-3, **at), 200)
    for a, b in zip(near, far, strict=False):
        assert b == pytest.approx(4 * a, abs=1e-15)


@pytest.mark.parametrize(
    "start",
    [
        {"workpiece.inclined.angle": -0.4, "workpiece.sine.amplitude": 1e-3},
        {"workpiece.ramp.rise": -0.03, "workpiece.inclined.angle": 0.4},
        {"workpiece.border.position": 2e-3},
        {"workpiece.hole.radius": 6e-3},
        {"workpiece.cylinder.radius": 0.02},
    ],
    ids="+".join,
)
def test_no_touch_begins_or_ends_within_the_clearance(load, start):
    """Moved by just less than the clearance in any direction, above the top or below it."""
    fmu = load("AxisRig.Sensors.DistanceSensor", electrode_radius=1e-3)
    above, below = ((-3e-3, 4e-3), (0.0, 2e-3), (3e-3, 1e-3)), ((6e-3, -2e-3), (0.0, -1e-3))
    for x, z in (*above, *below, (2e-3, -3e-3)):
        at = {"electrode_radius": 1e-3, "x_start": x, "x_end": x, "z_start": z, "z_end": z, **start}
        fmu.restart(**at)
        free, touching = 0.999 * fmu.clearance, fmu.touching
        for k in range(24):
            u, w = x + free * math.cos(k * math.pi / 12), z + free * math.sin(k * math.pi / 12)
            fmu.restart(**{**at, "x_start": u, "x_end": u, "z_start": w, "z_end": w})
            assert fmu.touching == touching
