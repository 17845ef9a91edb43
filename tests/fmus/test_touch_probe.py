"""Edges of the touch probe against closed forms of the crossing time."""

import math

import pytest
from fmpy.fmi1 import FMICallException

LOCATED = 1e-9  # s


class Motion:
    """Motion p(t) = p0 + v t + a t^2/2 in three axes."""

    def __init__(self, p0, v, a=(0.0, 0.0, 0.0)):
        self.p0, self.v, self.a = p0, v, a

    def inputs(self, t, size):
        """The inputs of one communication step."""
        values = {"step_time": t, "step_size": size}
        for name, p0, v, a in zip("xyz", self.p0, self.v, self.a, strict=True):
            for end, at in (("start", t), ("end", t + size)):
                values[f"{name}_{end}"] = p0 + v * at + a * at * at / 2
                values[f"{name}_rate_{end}"] = v + a * at
        return values

    def run(self, fmu, size, until):
        """Step `fmu` along the motion."""
        while fmu.time < until - size / 2:
            fmu.set(**self.inputs(fmu.time, size))
            fmu.step(size)
        return fmu


def started(probe, motion, size=1e-3, **start):
    return probe(**start, **motion.inputs(0.0, size))


STEPS = [0.1e-3, 0.25e-3, 1e-3, 2.5e-3]


@pytest.mark.parametrize("size", STEPS)
def test_edge_at_constant_velocity(probe, size):
    """0.12 m above, 0.05 m/s down: at 0.1 m after 0.4 s, whatever the step."""
    motion = Motion((0.0, 0.0, 0.1200123), (0.0, 0.0, -0.05))
    fmu = motion.run(started(probe, motion, size), size, 0.5)
    expected = 0.0200123 / 0.05
    assert fmu.rising_time == pytest.approx(expected, abs=LOCATED)
    assert fmu.contact_time == pytest.approx(expected, abs=LOCATED)
    assert fmu.contact_z == pytest.approx(0.1, abs=1e-10)
    assert (fmu.rising_count, fmu.falling_count, fmu.contact_count) == (1, 0, 1)
    assert fmu.signal is True


@pytest.mark.parametrize("size", STEPS)
def test_edge_at_constant_acceleration(probe, size):
    """Braking with 1 m/s^2 from 50 mm/s: 1 mm is passed at the smaller root."""
    motion = Motion((0.0, 0.0, 0.101), (0.0, 0.0, -0.05), (0.0, 0.0, 1.0))
    fmu = motion.run(started(probe, motion, size), size, 0.04)
    expected = 0.05 - math.sqrt(0.05**2 - 2 * 0.001)
    assert fmu.rising_time == pytest.approx(expected, abs=LOCATED)


@pytest.mark.parametrize("size", [*STEPS, 10e-3, 50e-3, 100e-3])
def test_touch_and_retreat_within_one_step(probe, size):
    """A parabola crosses the plane down and up again; at large steps both inside one."""
    motion = Motion((0.0, 0.0, 0.101), (0.0, 0.0, -0.05), (0.0, 0.0, 1.0))
    fmu = motion.run(started(probe, motion, size), size, 0.1)
    half = math.sqrt(0.05**2 - 2 * 0.001)
    assert fmu.rising_time == pytest.approx(0.05 - half, abs=LOCATED)
    assert fmu.falling_time == pytest.approx(0.05 + half, abs=LOCATED)
    assert (fmu.rising_count, fmu.falling_count) == (1, 1)
    assert fmu.signal is False
    assert fmu.contact is False


def test_pretravel_moves_the_edge_and_not_the_contact(probe):
    motion = Motion((0.0, 0.0, 0.11), (0.0, 0.0, -0.02))
    fmu = motion.run(started(probe, motion, pretravel=5e-6), 1e-3, 0.6)
    assert fmu.contact_time == pytest.approx(0.5, abs=LOCATED)
    assert fmu.rising_time == pytest.approx(0.5 + 5e-6 / 0.02, abs=LOCATED)


def test_trigger_delay_moves_both_edges(probe):
    motion = Motion((0.0, 0.0, 0.101), (0.0, 0.0, -0.05), (0.0, 0.0, 1.0))
    fmu = motion.run(started(probe, motion, trigger_delay=0.0123), 1e-3, 0.12)
    half = math.sqrt(0.05**2 - 2 * 0.001)
    assert fmu.rising_time == pytest.approx(0.05 - half + 0.0123, abs=LOCATED)
    assert fmu.falling_time == pytest.approx(0.05 + half + 0.0123, abs=LOCATED)
    assert fmu.contact_time == pytest.approx(0.05 - half, abs=LOCATED)


def test_pulse_shorter_than_the_delay_keeps_its_length(probe):
    """Touch of 10 ms behind a delay of 40 ms: both edges are under way at one time."""
    motion = Motion((0.0, 0.0, 0.1), (0.0, 0.0, -0.005), (0.0, 0.0, 1.0))
    high = Motion((0.0, 0.0, 0.1001), (0.0, 0.0, 0.0))
    fmu = started(probe, high, trigger_delay=0.040)
    fmu.set(**motion.inputs(0.0, 0.05))
    fmu.step(0.05)
    fmu.set(**motion.inputs(0.05, 0.05))
    fmu.step(0.05)
    assert fmu.rising_time == pytest.approx(0.040, abs=LOCATED)
    assert fmu.falling_time == pytest.approx(0.050, abs=LOCATED)


def test_five_touches_within_the_delay_are_an_error(probe):
    up, down = ({"z_start": z, "z_end": z} for z in (0.11, 0.09))
    fmu = probe(trigger_delay=0.1, **up)
    for inputs in (down, up) * 4:
        fmu.set(step_time=fmu.time, step_size=1e-3, **inputs)
        fmu.step(1e-3)
    fmu.set(step_time=fmu.time, step_size=1e-3, **down)
    with pytest.raises(FMICallException):
        fmu.step(1e-3)
    assert "more than four edges" in fmu.messages[-1]
    assert "EdgeQueue.mo" in fmu.messages[-1]


def test_four_touches_within_the_delay_all_arrive(probe):
    up, down = ({"z_start": z, "z_end": z} for z in (0.11, 0.09))
    fmu = probe(trigger_delay=0.1, **up)
    for inputs in (down, up) * 4 + (up,) * 150:
        fmu.set(step_time=fmu.time, step_size=1e-3, **inputs)
        fmu.step(1e-3)
    assert (fmu.rising_count, fmu.falling_count) == (4, 4)
    assert fmu.rising_time == pytest.approx(0.106, abs=LOCATED)
    assert fmu.falling_time == pytest.approx(0.107, abs=LOCATED)


def test_inverted_signal_falls_at_the_touch(probe):
    motion = Motion((0.0, 0.0, 0.11), (0.0, 0.0, -0.02))
    fmu = started(probe, motion, inverted=True)
    assert fmu.signal is True
    motion.run(fmu, 1e-3, 0.6)
    assert fmu.signal is False
    assert fmu.falling_time == pytest.approx(0.5, abs=LOCATED)
    assert (fmu.rising_count, fmu.falling_count) == (0, 1)


@pytest.mark.parametrize(("inverted", "level"), [(False, True), (True, False)])
def test_deflected_at_the_start_is_no_edge(probe, inverted, level):
    motion = Motion((0.0, 0.0, 0.09), (0.0, 0.0, 0.02))
    fmu = started(probe, motion, inverted=inverted)
    assert fmu.signal is level
    motion.run(fmu, 1e-3, 0.3)
    assert (fmu.rising_count, fmu.falling_count, fmu.contact_count) == (0, 0, 0)
    motion.run(fmu, 1e-3, 0.6)
    released = fmu.rising_time if inverted else fmu.falling_time
    assert released == pytest.approx(0.5, abs=LOCATED)


def test_ball_radius_and_inclined_plane(probe):
    """Approach along -z to a plane inclined by 30 degrees: gap = n.p - d - r."""
    normal = (math.sin(math.radians(30)), 0.0, math.cos(math.radians(30)))
    motion = Motion((0.02, -0.03, 0.2), (0.01, 0.0, -0.05))
    fmu = started(
        probe, motion, normal_x=normal[0], normal_z=normal[2], surface=0.1, ball_radius=0.003
    )
    motion.run(fmu, 1e-3, 2.5)
    gap0 = normal[0] * 0.02 + normal[2] * 0.2 - 0.103
    rate = normal[0] * 0.01 - normal[2] * 0.05
    contact = -gap0 / rate
    assert fmu.contact_time == pytest.approx(contact, abs=LOCATED)
    assert fmu.contact_x == pytest.approx(0.02 + 0.01 * contact, abs=1e-10)
    assert fmu.contact_y == pytest.approx(-0.03, abs=1e-15)
    assert fmu.contact_z == pytest.approx(0.2 - 0.05 * contact, abs=1e-10)
    assert fmu.gap == pytest.approx(gap0 + rate * 2.5, abs=1e-12)


def test_trigger_force_is_twice_as_large_between_two_pads(probe):
    """Lever law: F_p R/(2 L) over a pad, F_p R/L between two; 2.5 N, 50 mm, 10 mm, 0.2 N/um."""
    for degrees in range(0, 360, 20):
        phi = math.radians(degrees)
        fmu = probe(normal_x=math.cos(phi), normal_y=math.sin(phi), normal_z=0.0, seat_force=2.5)
        to_pad = min((degrees - pad) % 360 for pad in (0, 120, 240))
        turn = math.radians(min(to_pad, 120 - to_pad))
        expected = 2.5 * 0.010 / (2 * 0.050 * math.cos(turn)) / 0.2e6
        assert fmu.total_pretravel == pytest.approx(expected, rel=1e-12)
        assert 1.2499e-6 < fmu.total_pretravel < 2.5001e-6
    along = probe(seat_force=2.5, pretravel=1e-6)
    assert along.total_pretravel == pytest.approx(1e-6 + 2.5 / 2e6, rel=1e-12)


def test_pretravel_by_direction_moves_the_edge(probe):
    motion = Motion((-0.01, 0.0, 0.0), (0.02, 0.0, 0.0))
    wall = {"normal_x": -1.0, "normal_z": 0.0, "surface": 0.0, "seat_force": 2.5}
    fmu = motion.run(started(probe, motion, **wall), 1e-3, 0.6)
    assert fmu.contact_time == pytest.approx(0.5, abs=LOCATED)
    assert fmu.rising_time == pytest.approx(0.5 + 2.5e-6 / 0.02, abs=LOCATED)


def test_clearance_is_the_way_to_the_next_edge(probe):
    """Free: the gap. Between contact and switching point: the nearer one. Behind: the depth."""
    for z, expected in ((0.12, 0.02), (0.0999, 1e-4), (0.0998, 2e-4), (0.0990, 5e-4)):
        fmu = probe(z_start=z, z_end=z, pretravel=5e-4)
        assert fmu.clearance == pytest.approx(expected, abs=1e-15)


def test_clearance_is_zero_while_an_edge_is_under_way(probe):
    motion = Motion((0.0, 0.0, 0.1005), (0.0, 0.0, -0.05))
    fmu = started(probe, motion, trigger_delay=4e-3)
    seen = []
    for _ in range(16):
        motion.run(fmu, 1e-3, fmu.time + 1e-3)
        seen.append(fmu.clearance)
    assert all(c > 0 for c in seen[:9])
    assert seen[10:13] == [0, 0, 0]
    assert seen[14] == pytest.approx(0.05 * 5e-3, abs=1e-12)


@pytest.mark.parametrize("size", [2.0**-12, 2.0**-10, 2.0**-9])
def test_crossing_exactly_at_a_step_end_is_one_edge(probe, size):
    """Binary fractions, so that the gap is exactly zero at t = 0.125 s."""
    motion = Motion((0.0, 0.0, 0.25), (0.0, 0.0, -1.0))
    fmu = started(probe, motion, size, surface=0.125)
    motion.run(fmu, size, 0.125)
    assert fmu.gap == 0.0
    assert fmu.contact is True
    motion.run(fmu, size, 0.25)
    assert fmu.contact_time == pytest.approx(0.125, abs=LOCATED)
    assert (fmu.rising_count, fmu.contact_count) == (1, 1)


@pytest.mark.parametrize("units_in_last_place", range(-3, 4))
@pytest.mark.parametrize("begin", [0.0, 77.7, 1000.0])
def test_rounding_where_two_steps_meet_makes_no_edges(probe, units_in_last_place, begin):
    """The step boundary lies within a few roundings of the plane."""
    size, speed, z = 1e-3, 0.0123, 0.1
    for _ in range(abs(units_in_last_place)):
        z = math.nextafter(z, units_in_last_place * math.inf)
    path = [z + speed * size * k for k in (2, 1, 0, -1, -2)]
    fmu = probe(z_start=path[0], z_end=path[0])
    fmu.slave.reset()
    fmu.slave.enterInitializationMode(startTime=begin)
    fmu.set(step_time=begin, z_start=path[0], z_end=path[0])
    fmu.slave.exitInitializationMode()
    for k in range(4):
        fmu.time = begin + k * size
        fmu.set(step_time=fmu.time, step_size=size, z_start=path[k], z_end=path[k + 1])
        fmu.set(z_rate_start=-speed, z_rate_end=-speed)
        fmu.step(size)
    assert (fmu.rising_count, fmu.falling_count, fmu.contact_count) == (1, 0, 1)
    assert fmu.rising_time == pytest.approx(begin + 2 * size, abs=LOCATED)


def test_rest_on_the_plane_counts_once(probe):
    """The gap reaches zero and stays there: one contact, no chatter."""
    fmu = probe(z_start=0.11, z_end=0.11)
    for z_start, z_end in ((0.11, 0.1), (0.1, 0.1), (0.1, 0.1)):
        fmu.set(step_time=fmu.time, step_size=1e-3, z_start=z_start, z_end=z_end)
        fmu.step(1e-3)
    assert (fmu.rising_count, fmu.falling_count, fmu.contact_count) == (1, 0, 1)


def test_normal_must_be_a_unit_vector(load):
    with pytest.raises(FMICallException, match="ExitInitializationMode"):
        load("AxisRig.Sensors.TouchProbe", normal_x=0.5)
