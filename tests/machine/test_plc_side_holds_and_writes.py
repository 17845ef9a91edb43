"""Feedholds that overlap, objects of two drives, and what waits for a unit: columns by hand.

Turns at 0, 1, 2 ms ... as in `test_plc_side_by_hand.py`.
"""

import pytest
from tests.machine.test_plc_side_by_hand import Rules

from axisrig.kernel.distance import DistanceCommand
from axisrig.kernel.drives.cia402.objects import SdoError

pytestmark = pytest.mark.interpreted  # stand-ins for typed parts


class TwoDrives(Rules):
    """Both axes have drives with objects."""

    DRIVES = "XZ"


def held(on: Rules, count: int) -> list[str]:
    """What is held in each turn: P the path, X, Z."""
    found = []
    for _ in range(count):
        on.turns()
        names = "P" * on.plc.feedhold
        names += "".join(name for name, unit in on.plc.axis.items() if unit.feedhold)
        found.append(names)
    return found


@pytest.mark.parametrize(("column", "name"), [("feedhold", "P"), ("X__feedhold", "X")])
def test_feedholds_of_one_path_or_axis_that_overlap_are_one(column: str, name: str) -> None:
    """1 to 6 ms, 2 to 4 ms and 3 to 8 ms: held from 1 to 8 ms, on and off are noted once."""
    on = Rules(**{column: "at=1ms for=5ms; at=2ms for=2ms; at=3ms for=5ms"})
    assert held(on, 10) == ["", *[name] * 7, "", ""]
    words = "feedhold" if name == "P" else "feedhold of X"
    assert on.words() == [(1.0, f"{words} on"), (8.0, f"{words} off")]


def test_feedholds_of_path_and_axes_are_noted_each_by_itself() -> None:
    on = Rules(
        feedhold="at=1ms for=2ms", X__feedhold="at=1ms for=4ms", Z__feedhold="at=2ms for=1ms"
    )
    assert held(on, 6) == ["", "PX", "PXZ", "X", "X", ""]
    assert on.words() == [
        (1.0, "feedhold on"), (1.0, "feedhold of X on"), (2.0, "feedhold of Z on"),
        (3.0, "feedhold off"), (3.0, "feedhold of Z off"), (5.0, "feedhold of X off"),
    ]  # fmt: skip


def test_a_feedhold_that_comes_again_is_noted_again() -> None:
    on = Rules(Z__feedhold="at=1ms for=1ms; at=4ms for=2ms")
    assert held(on, 7) == ["", "Z", "", "", "Z", "Z", ""]
    words = [f"feedhold of Z {word}" for word in ("on", "off", "on", "off")]
    assert on.words() == list(zip((1.0, 2.0, 4.0, 6.0), words, strict=True))


def test_objects_are_written_to_the_drive_of_their_axis() -> None:
    """Time of the lag window of X, torque limit of Z, lag window of both (CiA 402)."""
    on = TwoDrives(X__lag_window_time="10 at=1ms", Z__torque_limit="300 at=1ms", X__6065="7 at=2ms",
                   Z__6065="8 at=2ms")  # fmt: skip
    on.turns(3)
    little = {"X": [(0x6066, 10, 2), (0x6065, 7, 4)], "Z": [(0x6072, 300, 2), (0x6065, 8, 4)]}
    for name, writes in little.items():
        expected = [(index, 0, value.to_bytes(size, "little")) for index, value, size in writes]
        assert on.sdos[name].writes == expected


@pytest.mark.parametrize(
    ("name", "number", "index", "size"),
    [  # CiA 402-2: index and type, UNSIGNED16 or UNSIGNED32
        ("torque_limit", "6072", 0x6072, 2), ("torque_limit_positive", "60E0", 0x60E0, 2),
        ("torque_limit_negative", "60E1", 0x60E1, 2), ("lag_window", "6065", 0x6065, 4),
        ("lag_window_time", "6066", 0x6066, 2),
    ],
)  # fmt: skip
def test_each_object_has_its_index_and_size(name: str, number: str, index: int, size: int) -> None:
    """By its name and by its number; the largest value fits."""
    for word, value in ((name, 1), (number, 256**size - 1)):
        on = Rules(**{f"Z__{word}": f"{value} at=1ms"})
        on.turns(2)
        assert on.sdo.writes == [(index, 0, value.to_bytes(size, "little"))]


def test_each_drive_answers_for_itself() -> None:
    """Both at M50; X refuses, Z takes it later: the alarm is that of X, M50 waits for both."""
    on = TwoDrives(X__torque_limit="300 at=M50", Z__torque_limit="400 at=M50")
    on.turns().sends(50).turns()
    on.sdos["X"].answer(SdoError(0x6072, 0, 0x06090030))
    (alarm,) = on.plc.reported
    assert (alarm.values["axis"], alarm.values["column"]) == ("X", "plc:X.torque_limit")
    assert alarm.values["value"] == 300
    assert on.plc.is_waiting()
    on.sdos["Z"].answer()
    assert not on.plc.is_waiting()
    assert [words for _, words in on.words()] == [
        "X.torque_limit = 300 from the PLC", "Z.torque_limit = 400 from the PLC",
        "Z.torque_limit = 400: the drive has taken it",
    ]  # fmt: skip


def test_a_command_is_noted_without_its_moment() -> None:
    """Neither the time nor which one of several; set values stay."""
    on = Rules(Z__dist_ctrl="OFF at=M50 nth=2; ON set_pos=0 set_dist=0 at=M51+1ms")
    on.turns().sends(50, 50, 51).turns(3)
    assert [words for _, words in on.words()] == [
        "Z.dist_ctrl = OFF from the PLC", "Z.dist_ctrl = ON set_pos=0 set_dist=0 from the PLC",
    ]  # fmt: skip


def test_0_is_a_set_value_of_a_command() -> None:
    on = Rules(Z__dist_ctrl="ON set_pos=0 at=1ms; ON_CONST_DIST set_dist=0 at=2ms; OFF at=3ms")
    unit, taken = on.plc.axis["Z"].distance, []
    for _ in range(5):
        on.turns()
        if unit.command_semaphor_rw:
            unit.command_semaphor_rw, wanted = False, unit.command_w
            taken.append((wanted.transition, wanted.set_pos_mm, wanted.set_dist_mm))
    assert taken == [
        (DistanceCommand.ON, 0.0, None), (DistanceCommand.ON_CONST_DIST, None, 0.0),
        (DistanceCommand.OFF, None, None),
    ]  # fmt: skip


@pytest.mark.parametrize("cells", [{"Z__dist_ctrl": "OFF at=program_end"},
                                   {"Z__set_dist": "2 at=program_end"}])  # fmt: skip
def test_the_plc_side_has_something_to_do_while_a_unit_has_not_taken_its_command(
    cells: dict[str, str],
) -> None:
    on = Rules(**cells)
    unit = on.plc.axis["Z"].distance
    unit.command_semaphor_rw = True  # one from before
    on.turns()
    on.channel.program_ends_ns.append(on.clock.now_ns)
    assert not on.turns(2).plc.is_idle()
    unit.command_semaphor_rw = False
    assert on.turns().plc.is_idle()
    assert unit.command_semaphor_rw


@pytest.mark.parametrize(
    ("cells", "words"),
    [
        ({"Z__set_dist": "2 at=1ms over=1.5ms"}, "Z.set_dist_mm = 2 over 1.5 ms from the PLC"),
        ({"Z__set_pos": "-0.25 at=1ms"}, "Z.set_pos_mm = -0.25 from the PLC"),
        ({"override": "12.5 at=1ms"}, "override = 12.5 % from the PLC"),
        ({"X__override": "0 at=1ms over=2ms"}, "X.override = 0 % over 2 ms from the PLC"),
        ({"V__E__A": "0; -1.5 at=1ms"}, "V.E.A = -1.5 from the PLC"),
        ({"reset": "at=1ms"}, "reset from the PLC"),
        ({"program_start": "at=1ms"}, "start of the program from the PLC"),
    ],
)
def test_what_was_done_is_noted_with_its_column(cells: dict[str, str], words: str) -> None:
    on = Rules(**cells)
    on.turns(2)
    assert on.words() == [(1.0, words)]
    (name,) = cells
    assert [event.command.place for event in on.plc.events] == [  # type: ignore[union-attr]
        f"plc:{name.replace('__', '.')}"
    ]
