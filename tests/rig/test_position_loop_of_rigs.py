"""Where a rig closes its position loops, and what `check` refuses of one in the CNC."""

from collections.abc import Callable
from pathlib import Path

import pytest

from axisrig.bench.rig.canopen.family import FAMILY
from axisrig.bench.rig.check import check_rig
from axisrig.bench.rig.loop import check_gain, feed_forward
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.drives.canopen.mapping import telegrams
from axisrig.kernel.errors import UserError

Write = Callable[..., Path]
Read = Callable[..., Settings]
CSV = ("lead_mm = 10.0", "lead_mm = 10.0\nmode = 9")
ON_ETHERCAT = (
    ("[segment.can1]\nbitrate = 1_000_000", '[segment.can1]\ncarrier = "ethercat"'),
    ("node = 3\n", ""),
)


@pytest.fixture
def rig(rig_file: Write) -> Write:
    """Write a rig with further lines in the list of Z."""

    def write(*changes: tuple[str, str], lines: str = "") -> Path:
        path = rig_file(*changes)
        with (path.parent / "lists" / "axis-z.lst").open("a", encoding="utf-8") as file:
            file.write(lines)
        return path

    return write


@pytest.mark.parametrize(
    ("changes", "cell", "limit_per_s"),
    [
        # T 1 ms, set speeds interpolated: 2 tan(pi/(4 (n + 1)))/T with n = 1
        ((), (), 828.427),
        # held: 2 sin(pi/(2 (2 n + 1)))/T
        ((), ("drive:servo.velocity_demand=held",), 1000.0),
        # A speed loop of 1 ms is a dead cycle more
        ((), ("drive:servo.velocity_demand=held", "drive:servo.speed_loop_us=1000"), 618.034),
        ((), ("drive:servo.speed_loop_us=500",), 649.839),
        # On EtherCAT a set value acts one cycle later
        (ON_ETHERCAT, ("drive:servo.velocity_demand=held",), 618.034),
    ],
)
def test_a_gain_beyond_its_limit_is_refused(
    rig: Write, settings_of: Read, changes: tuple[tuple[str, str], ...],
    cell: tuple[str, ...], limit_per_s: float,
) -> None:  # fmt: skip
    for share in (0.999, 1.001):
        kv = round(100 * share * limit_per_s)
        path = rig(CSV, *changes, lines="")
        settings = settings_of(path, f"set:Z.getriebe[0].kv={kv}", *cell)
        if share < 1.0:
            check_rig(settings)
            continue
        with pytest.raises(UserError, match="unstable with Kv") as caught:
            check_rig(settings)
        allowed = float(str(caught.value.allowed).split()[1])
        assert allowed == pytest.approx(100 * limit_per_s, rel=1e-5)


def test_a_gain_of_the_list_is_refused_at_its_line(rig: Write, settings_of: Read) -> None:
    path = rig(CSV, lines="getriebe[0].kv 100000\n")
    with pytest.raises(UserError, match=r"Kv = 1000 1/s .*below 0.8284 with 1 dead") as caught:
        check_rig(settings_of(path))
    assert (Path(str(caught.value.file)).name, caught.value.line) == ("axis-z.lst", 2)


@pytest.mark.parametrize(
    ("mode", "word", "allowed"),
    [
        (9, "DRIVE_POSITION_CONTROL", "DRIVE_DEFAULT, CNC_POSITION_CONTROL"),
        (8, "CNC_POSITION_CONTROL", "DRIVE_DEFAULT, DRIVE_POSITION_CONTROL"),
    ],
)
def test_the_place_of_the_loop_is_that_of_the_telegram(
    rig: Write, settings_of: Read, mode: int, word: str, allowed: str
) -> None:
    """TF5200 commissioning 436095115: with CANopen the telegram decides it."""
    changed = (CSV[0], f"{CSV[0]}\nmode = {mode}")
    path = rig(changed, lines=f"antr.operation_mode {word}\n")
    with pytest.raises(UserError, match="closes the position loop") as caught:
        check_rig(settings_of(path))
    assert (caught.value.line, caught.value.allowed) == (2, allowed)
    for good in allowed.split(", "):
        check_rig(settings_of(path, f"set:Z.antr.operation_mode={good}"))


TABLE = """\
pdo,transmission,inhibit_100us,index,sub,bits,signed,field
RPDO1,1,0,0x6040,0,16,no,controlword
RPDO1,1,0,{target}
TPDO1,1,0,0x6041,0,16,no,statusword
TPDO1,1,0,0x6064,0,32,yes,actual
"""
POSITION, SPEED = "0x607A,0,32,yes,target", "0x60FF,0,32,yes,speed"


@pytest.mark.parametrize(("target", "mode"), [(POSITION, 9), (SPEED, 8)])
def test_a_mode_that_follows_another_value_than_the_table_carries_is_refused(
    rig: Write, settings_of: Read, tmp_path: Path, target: str, mode: int
) -> None:
    (tmp_path / "own.csv").write_text(TABLE.format(target=target), encoding="utf-8")
    path = rig((CSV[0], f'{CSV[0]}\nmode = {mode}\npdo_map = "own.csv"'))
    with pytest.raises(UserError, match="follows the other one") as caught:
        check_rig(settings_of(path))
    assert caught.value.allowed == str(17 - mode)
    check_rig(settings_of(path, f"drive:servo.mode={17 - mode}"))


def test_a_table_has_a_set_position_or_a_set_speed(
    rig: Write, settings_of: Read, tmp_path: Path
) -> None:
    (tmp_path / "own.csv").write_text(TABLE.format(target="0x60FF,0,32,yes,"), encoding="utf-8")
    path = rig((CSV[0], f'{CSV[0]}\npdo_map = "own.csv"'))
    with pytest.raises(UserError, match="mapping table lacks a field") as caught:
        check_rig(settings_of(path))
    assert caught.value.allowed == "one of them, or both"


@pytest.mark.parametrize("mode", [8, 9])
def test_of_both_in_a_table_the_mode_decides(
    rig: Write, settings_of: Read, tmp_path: Path, mode: int
) -> None:
    """So the kernel's own table can be copied and changed."""
    both = f"{POSITION}\nRPDO1,1,0,{SPEED}"
    (tmp_path / "own.csv").write_text(TABLE.format(target=both), encoding="utf-8")
    path = rig((CSV[0], f'{CSV[0]}\nmode = {mode}\npdo_map = "own.csv"'))
    check_rig(settings_of(path))
    found = telegrams(0x60BA, str(tmp_path / "own.csv"), speed=mode == 9)
    assert [one.index for one in found["RPDO1"].objects] == [
        0x6040,
        0x60FF if mode == 9 else 0x607A,
    ]


def test_distance_control_needs_the_loop_in_the_drive(
    rig: Write, settings_of: Read, tmp_path: Path
) -> None:
    path = rig(CSV, ('plant = "z"\n', 'plant = "z"\nencoder_2 = "load"\n'),
               lines="lr_param.distance_control_on 1\n")  # fmt: skip
    with pytest.raises(UserError, match=r"distance control .* closes the position loop"):
        check_rig(settings_of(path))
    path.write_text(path.read_text().replace('encoder_2 = "load"\n', ""), encoding="utf-8")
    check_rig(settings_of(path, "set:Z.lr_param.distance_control_on=0"))
    with (tmp_path / "lists" / "channel.lst").open("a", encoding="utf-8") as file:
        file.write("configuration.decoder.function FCT_3D_DIST_CTRL\ndist_ctrl[0].a_max 1000\n")
    with pytest.raises(UserError, match=r"3D distance control .* closes the position loop"):
        check_rig(settings_of(path, "set:Z.lr_param.distance_control_on=0"))


def test_check_says_where_a_loop_is_closed(rig: Write, settings_of: Read) -> None:
    forward = "vorsteuer.default_active 1\nvorsteuer.vorsteuerung 1\nvorsteuer.vs_v_nenner 4\n"
    settings = settings_of(rig(CSV, lines=f"getriebe[0].kv 2500\n{forward}"))
    (line,) = [text for text in FAMILY.describe(settings) if "position loop" in text]
    assert "Kv 25 1/s, feed-forward 0.25, lag 0.3 mm at 10 mm/s; stable below 828.4 1/s" in line
    settings = settings_of(rig((CSV[0], CSV[0]), lines=""))
    (line,) = [text for text in FAMILY.describe(settings) if "position loop" in text]
    assert line.startswith("warning: axis Z: its drive closes the position loop")
    assert "getriebe[0].kv" in line


@pytest.mark.parametrize(
    ("share", "refused"), [(1.0, True), (1.0 + 1e-9, True), (1.0 - 1e-9, False), (0.5, False)]
)
def test_a_gain_at_its_limit_is_refused_too(
    rig: Write, settings_of: Read, share: float, refused: bool
) -> None:
    """There the loop rings for ever. Kv 20 1/s, T 1 ms, 3 dead cycles; P-AXIS-00099 is 0.01 1/s."""
    settings = settings_of(rig(CSV, lines="getriebe[0].kv 2000\n"))
    given = ("Z", 0.02 / share, 3.0, 0.001, "CNC", "lower it")
    if not refused:
        check_gain(settings, *given)
        return
    with pytest.raises(UserError) as caught:
        check_gain(settings, *given)
    error = caught.value
    assert "the position loop of the CNC is unstable with Kv = 20 1/s" in error.message
    assert "Kv T is 0.02 and must be below 0.02 with 3 dead cycles" in error.message
    assert (error.value, error.allowed, error.hint) == (2000, "below 2000 0.01/s", "lower it")


@pytest.mark.parametrize(
    ("lines", "share"),
    [
        ("", 0.0),
        ("vorsteuer.vorsteuerung 1\nvorsteuer.default_active 1\n", 1.0),
        ("vorsteuer.vorsteuerung 3\nvorsteuer.default_active 1\n", 1.0),
        ("vorsteuer.vorsteuerung 2\nvorsteuer.default_active 1\n", 0.0),  # acceleration alone
        ("vorsteuer.vorsteuerung 1\nvorsteuer.default_active 0\n", 0.0),
        (
            "vorsteuer.vorsteuerung 1\nvorsteuer.default_active 1\nvorsteuer.global_disable 1\n",
            0.0,
        ),
        (
            "vorsteuer.vorsteuerung 1\nvorsteuer.default_active 1\nvorsteuer.vs_v_faktor 3\n"
            "vorsteuer.vs_v_nenner 4\n",
            0.75,
        ),
    ],
)
def test_the_set_speed_is_fed_forward_where_everything_of_the_list_wants_it(
    rig: Write, settings_of: Read, lines: str, share: float
) -> None:
    """P-AXIS-00223 bit 0 is the speed; on by P-AXIS-00255, scaled by P-AXIS-00228 / 00229."""
    assert feed_forward(settings_of(rig(CSV, lines=lines)), "Z") == share
