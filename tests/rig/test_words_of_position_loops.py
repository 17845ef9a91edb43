"""What `check` shows of a position loop in the CNC: its limit of Kv, dead cycles and lag."""

import math
import re
from collections.abc import Callable
from pathlib import Path

import pytest

from axisrig.bench.oracles.position_loop import dead_cycles, gain_limit, ramp_lag_mm
from axisrig.bench.rig.canopen.loop import check_loop, describe_loop, loop_settings
from axisrig.bench.rig.canopen.schedule import axis_telegrams
from axisrig.bench.rig.check import check_rig
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.errors import UserError

Write = Callable[..., Path]
Read = Callable[..., Settings]
CSV = ("lead_mm = 10.0", "lead_mm = 10.0\nmode = 9")
WORDS = re.compile(
    r"Kv ([\d.]+) 1/s, feed-forward ([\d.]+), lag ([\d.]+) mm at 10 mm/s; stable below"
    r" ([\d.]+) 1/s with ([\d.]+) dead cycles"
)
LIST = "getriebe[0].kv 2500\n"


def words(settings: Settings, late: int = 0) -> tuple[float, ...]:
    """Kv, feed-forward, lag, limit of Kv, dead cycles as shown."""
    (line,) = describe_loop(settings, "Z", late)
    assert line.startswith("axis Z: the CNC closes the position loop")
    found = WORDS.search(line)
    assert found is not None, line
    return tuple(map(float, found.groups()))


@pytest.fixture
def rig(rig_file: Write, settings_of: Read) -> Read:
    """Settings of a rig with further lines in the list of Z."""

    def make(
        *cells: str, lines: str = LIST, changes: tuple[tuple[str, str], ...] = (CSV,)
    ) -> Settings:
        path = rig_file(*changes)
        (path.parent / "lists" / "axis-z.lst").write_text(
            f"kopf.log_achs_name Z\n{lines}", encoding="utf-8"
        )
        return settings_of(path, *cells)

    return make


@pytest.mark.parametrize("late", [0, 1, 2, 3, 5])
@pytest.mark.parametrize("demand", ["interpolated", "held"])
@pytest.mark.parametrize("speed_loop_us", [0, 250, 1000])
def test_the_limit_counts_the_cycles_of_the_carrier_and_of_the_speed_loop(
    rig: Read, late: int, demand: str, speed_loop_us: int
) -> None:
    """n = 1 + late + speed loop/T; held 2 sin(pi/(2(2n+1)))/T, else 2 tan(pi/(4(n+1)))/T."""
    cells = [f"drive:servo.speed_loop_us={speed_loop_us}"]
    cells += ["drive:servo.velocity_demand=held"] if demand == "held" else []
    n = 1 + late + speed_loop_us / 1000
    if demand == "held":
        limit = 2000 * math.sin(math.pi / (2 * (2 * n + 1)))
    else:
        limit = 2000 * math.tan(math.pi / (4 * (n + 1)))
    *_, shown, dead = words(rig(*cells), late)
    assert shown == pytest.approx(limit, rel=1e-3)
    assert dead == pytest.approx(n, rel=1e-3)


@pytest.mark.parametrize("period_us", [500, 1000, 2000, 4000])
def test_the_limit_is_by_the_time_and_the_dead_cycles_by_the_period(
    rig: Read, period_us: int
) -> None:
    """A speed loop of 1 ms is 2, 1, 0.5 and 0.25 of these periods."""
    changes = (CSV, ("cycle_offset_us = 600", f"period_us = {period_us}\ncycle_offset_us = 300"))
    n = 1 + 1000 / period_us
    limit = 2 * math.tan(math.pi / (4 * (n + 1))) / (period_us * 1e-6)
    *_, shown, dead = words(rig("drive:servo.speed_loop_us=1000", changes=changes))
    assert (shown, dead) == (pytest.approx(limit, rel=1e-3), pytest.approx(n, rel=1e-3))
    loop = loop_settings(rig("drive:servo.speed_loop_us=1000", changes=changes), "Z")
    assert loop is not None
    assert loop.period_s == period_us * 1e-6


@pytest.mark.parametrize("late", [0, 1])
def test_what_is_shown_is_what_is_refused(rig: Read, late: int) -> None:
    """Just below it the rig is taken, just above not; on EtherCAT a value is a cycle late."""
    ethercat = (
        ("[segment.can1]\nbitrate = 1_000_000", '[segment.can1]\ncarrier = "ethercat"'),
        ("node = 3\n", ""),
    )
    changes = (CSV, *(ethercat if late else ()))
    *_, shown, _ = words(rig(changes=changes), late)
    for share, is_taken in ((0.998, True), (1.002, False)):
        settings = rig(f"set:Z.getriebe[0].kv={round(100 * share * shown)}", changes=changes)
        if is_taken:
            check_rig(settings)
            continue
        with pytest.raises(UserError, match="is unstable with Kv"):
            check_rig(settings)


@pytest.mark.parametrize(
    ("lines", "forward"),
    [
        ("", 0.0),
        ("vorsteuer.default_active 1\nvorsteuer.vorsteuerung 1\nvorsteuer.vs_v_faktor 3\n"
         "vorsteuer.vs_v_nenner 4\n", 0.75),
        # Not of the speed (bit 0), not on, and switched off for all
        ("vorsteuer.default_active 1\nvorsteuer.vorsteuerung 2\nvorsteuer.vs_v_nenner 4\n", 0.0),
        ("vorsteuer.default_active 0\nvorsteuer.vorsteuerung 1\nvorsteuer.vs_v_nenner 4\n", 0.0),
        ("vorsteuer.default_active 1\nvorsteuer.vorsteuerung 1\nvorsteuer.global_disable 1\n", 0.0),
        ("vorsteuer.default_active 1\nvorsteuer.vorsteuerung 3\nvorsteuer.vs_v_nenner 2\n", 0.5),
    ],
)  # fmt: skip
@pytest.mark.parametrize("kv", [1000, 2500, 10_000])
def test_the_lag_is_that_of_the_gain_and_the_feed_forward(
    rig: Read, lines: str, forward: float, kv: int
) -> None:
    """P-AXIS-00099 is in 0.01/s; (1 - f) v/Kv at 10 mm/s."""
    shown_kv, shown_forward, lag_mm, *_ = words(rig(lines=f"getriebe[0].kv {kv}\n{lines}"))
    assert (shown_kv, shown_forward) == (kv / 100, forward)
    assert lag_mm == pytest.approx((1 - forward) * 10 / (kv / 100), rel=1e-3)


OF_LOOP = {
    "getriebe[0].kv": 2500, "vorsteuer.vorsteuerung": 1, "vorsteuer.vs_v_faktor": 1,
    "vorsteuer.vs_v_nenner": 2, "vorsteuer.default_active": 1, "vorsteuer.global_disable": 0,
}  # fmt: skip


@pytest.mark.parametrize("given", [*([path] for path in OF_LOOP), [*OF_LOOP], [*OF_LOOP][1:3]])
def test_parameters_of_a_loop_that_is_in_the_drive_are_named(rig: Read, given: list[str]) -> None:
    lines = "".join(f"{path} {OF_LOOP[path]}\n" for path in given)
    settings = rig(lines=lines, changes=())
    assert loop_settings(settings, "Z") is None
    (line,) = describe_loop(settings, "Z", 0)
    assert line == (
        "warning: axis Z: its drive closes the position loop, so that"
        f" {', '.join(given)} of its list count for nothing"
    )


def test_of_a_loop_in_the_drive_without_such_parameters_nothing_is_shown(rig: Read) -> None:
    assert describe_loop(rig(lines="", changes=()), "Z", 0) == []


@pytest.mark.parametrize(
    ("late", "speed_loop_ns", "period_ns", "dead"),
    [(0, 0, 1_000_000, 1.0), (2, 0, 1_000_000, 3.0), (0, 500_000, 1_000_000, 1.5),
     (1, 500_000, 250_000, 4.0), (0, 1_000_000, 4_000_000, 1.25)],
)  # fmt: skip
def test_dead_cycles_are_counted_from_the_next_sync_on(
    late: int, speed_loop_ns: int, period_ns: int, dead: float
) -> None:
    assert dead_cycles(late, speed_loop_ns, period_ns) == dead


@pytest.mark.parametrize(
    ("dead", "held", "interpolated"),
    [
        (0, 2.0, 2.0),  # sin(pi/2), tan(pi/4)
        (1, 1.0, 2 * (math.sqrt(2) - 1)),  # sin(pi/6), tan(pi/8)
        (2, (math.sqrt(5) - 1) / 2, 2 * (2 - math.sqrt(3))),  # sin(pi/10), tan(pi/12)
    ],
)
def test_limits_of_whole_dead_cycles_are_those_of_their_angles(
    dead: int, held: float, interpolated: float
) -> None:
    assert gain_limit(dead, is_held=True) == pytest.approx(held, rel=1e-12)
    assert gain_limit(dead, is_held=False) == pytest.approx(interpolated, rel=1e-12)


@pytest.mark.parametrize("is_held", [True, False])
@pytest.mark.parametrize("dead", [0, 1, 2, 3])
def test_a_sampled_loop_is_stable_below_its_limit_and_not_above(dead: int, is_held: bool) -> None:
    """Its error after 4000 cycles has gone, or has grown."""
    for share in (0.99, 1.01):
        gain, x, sent = share * gain_limit(dead, is_held=is_held), 1.0, [0.0] * (dead + 2)
        for _ in range(4000):
            sent = [-gain * x, *sent[:-1]]
            x += sent[dead] if is_held else (sent[dead] + sent[dead + 1]) / 2
            if abs(x) > 1e6:
                break
        assert (max(abs(x), *map(abs, sent)) < 1.0) is (share < 1.0)


def test_the_lag_of_a_ramp_is_the_speed_over_the_gain() -> None:
    assert ramp_lag_mm(100.0, 25.0) == pytest.approx(4.0)
    assert ramp_lag_mm(-100.0, 25.0, 0.75) == pytest.approx(-1.0)
    assert ramp_lag_mm(100.0, 25.0, 1.0) == 0.0


@pytest.mark.parametrize(("late", "dead"), [(0, "1"), (1, "2"), (2, "3")])
@pytest.mark.parametrize("speed_loop_us", [0, 500])
def test_a_gain_is_refused_with_the_dead_cycles_of_its_carrier(
    rig: Read, late: int, dead: str, speed_loop_us: int
) -> None:
    """One until the set speed acts, those of the carrier, and the speed loop of the drive."""
    settings = rig(f"drive:servo.speed_loop_us={speed_loop_us}", lines="getriebe[0].kv 200000\n")
    shown = f"{int(dead) + speed_loop_us / 1000:g}"
    with pytest.raises(UserError, match=f"with {shown} dead"):
        check_loop(settings, "Z", axis_telegrams(settings, "Z").values(), late)


def test_each_axis_has_gain_and_feed_forward_of_its_own_list(rig_above: Read) -> None:
    """P-AXIS-00099 in 0.01 1/s; the loop of Y is in its drive."""
    text = '[drive.speed]\nmode = 9\n[axis.X]\ndrive = "speed"\n[axis.Z]\ndrive = "speed"'
    settings = rig_above(
        "probe-xyz.toml", text, "set:X.getriebe[0].kv=1200", "set:Y.getriebe[0].kv=1700",
        "set:Z.getriebe[0].kv=2300",
    )  # fmt: skip
    found = {axis: loop_settings(settings, axis) for axis in "XYZ"}
    assert {axis: loop and loop.kv_per_s for axis, loop in found.items()} == {
        "X": 12.0, "Y": None, "Z": 23.0,
    }  # fmt: skip
    for axis, kv in (("X", "12"), ("Z", "23")):
        (line,) = describe_loop(settings, axis, 0)
        assert line.startswith(f"axis {axis}: the CNC closes the position loop: Kv {kv} 1/s")
