"""PROFIdrive axes of a rig: their loops, their second encoders, what a drive has to have."""

from collections.abc import Callable

import pytest

from axisrig.bench.rig.cyclic.family import FAMILY
from axisrig.bench.rig.families import SecondEncoder
from axisrig.bench.rig.loop import KV
from axisrig.bench.rig.profidrive.checks import check_profidrive
from axisrig.bench.rig.profidrive.expected import expected_parameters
from axisrig.bench.rig.profidrive.loop import check_loop, loop_settings
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.errors import UserError

Read = Callable[..., Settings]
PROBE, DISTANCE = "probe-z-profidrive.toml", "distance-z-profidrive.toml"
IN_CNC = "set:Z.antr.operation_mode=CNC_POSITION_CONTROL"
LISTED = "set:Z.antr.profibus.drive_velocity_base_value="


@pytest.mark.parametrize(
    ("p0880", "listed", "factor"),
    [(8192, 16_384, "0.5"), (16_384, 8192, "2"), (3000, 6000, "0.5"), (6000, 4000, "1.5")],
)
def test_a_speed_base_of_the_list_that_is_not_that_of_the_drive_is_refused(
    rig_above: Read, p0880: int, listed: int, factor: str
) -> None:
    """NSOLL_B is a share of p0880: the drive turns so many times as fast as the control wants."""
    settings = rig_above(PROBE, f"[drive.servo]\np0880 = {p0880}", f"{LISTED}{listed}")
    with pytest.raises(UserError, match=r"P-AXIS-00379") as caught:
        check_profidrive(settings, "Z", 0)
    assert f"a factor of {factor} (" in caught.value.message
    assert (caught.value.value, str(caught.value.allowed)) == (listed, str(p0880))


def test_equal_speed_bases_are_taken_whatever_they_are(rig_above: Read) -> None:
    for base in (3000, 16_384):
        settings = rig_above(PROBE, f"[drive.servo]\np0880 = {base}", f"{LISTED}{base}")
        check_profidrive(settings, "Z", 0)


@pytest.mark.parametrize("telegram", [3, 5, 105])
def test_the_drive_has_to_have_the_telegram_of_the_rig(rig_above: Read, telegram: int) -> None:
    """P922 of the drive, whichever it is."""
    text = f"[drive.servo]\nparameter_check = true\ntelegram = {telegram}"
    first, *_ = expected_parameters(rig_above(PROBE, text), "Z")
    assert tuple(first) == (922, telegram, "telegram of the rig")


@pytest.mark.parametrize(("period", "period_s"), [("", 0.001), ("-2ms", 0.002), ("-4ms", 0.004)])
@pytest.mark.parametrize("kv", [1000, 4000])
def test_a_loop_in_the_cnc_has_the_cycle_of_the_rig_and_the_gain_of_the_list(
    rig_above: Read, period: str, period_s: float, kv: int
) -> None:
    """P-AXIS-00099 is in 0.01 1/s, the cycle in s."""
    name = PROBE.replace(".toml", f"{period}.toml")
    loop = loop_settings(rig_above(name, "", IN_CNC, f"set:Z.{KV}={kv}"), "Z")
    assert loop is not None
    assert (loop.kv_per_s, loop.period_s) == (kv / 100, period_s)


@pytest.mark.parametrize(
    ("changes", "where", "hint"),
    [((), "drive (DSC)", "a shorter tick_us"), ((IN_CNC,), "CNC", "shorter period_us")],
)
def test_an_unstable_loop_is_refused_by_who_closes_it(
    rig_above: Read, changes: tuple[str, ...], where: str, hint: str
) -> None:
    """With 5 ms of speed loop neither is stable at 1000 1/s: pi / (2 * 5 ms) is 314 1/s."""
    text = "[drive.servo]\nspeed_loop_us = 5000"
    settings = rig_above(PROBE, text, f"set:Z.{KV}=100000", *changes)
    with pytest.raises(UserError) as caught:
        check_loop(settings, "Z", 0)
    assert (
        f"the position loop of the {where} is unstable with Kv = 1000 1/s" in caught.value.message
    )
    assert caught.value.value == 100_000
    assert hint in str(caught.value.hint)
    check_loop(rig_above(PROBE, text, f"set:Z.{KV}=1000", *changes), "Z", 0)


@pytest.mark.parametrize("period_us", [1000, 2000])
def test_a_second_encoder_in_the_telegram_comes_in_each_cycle(
    rig_above: Read, period_us: int
) -> None:
    settings = rig_above(DISTANCE, f"[cycle]\nperiod_us = {period_us}")
    words = "G2_XIST1, in the telegram of each cycle"
    assert FAMILY.second_encoder(settings, "Z") == SecondEncoder(words, 1, period_us * 1000)


@pytest.mark.parametrize("telegram", [3, 5, 105])
def test_a_telegram_with_one_encoder_has_no_second_one(rig_above: Read, telegram: int) -> None:
    settings = rig_above(PROBE, f"[drive.servo]\ntelegram = {telegram}")
    assert FAMILY.second_encoder(settings, "Z") is None
