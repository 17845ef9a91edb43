"""The table of drive types, beside that of parameters and the rooms that simulate a family."""

from collections.abc import Callable
from importlib.util import find_spec

import pytest

from axisrig.kernel.errors import Alarm, UserError
from axisrig.kernel.parameters import ParameterSet, start_up
from axisrig.kernel.parameters.drive_types import DRIVE_TYPES, SIMULATED
from axisrig.kernel.parameters.start_up import DRIVE_TYPE
from axisrig.kernel.parameters.table import table

Listed = Callable[..., ParameterSet]
STOP = "kenngr.measure.fixed_stop_detect.pos_lag_limit"
DEFAULT, DRIVE, CNC, DSC = (
    "DRIVE_DEFAULT", "DRIVE_POSITION_CONTROL", "CNC_POSITION_CONTROL", "DSC_POSITION_CONTROL",
)  # fmt: skip


def started(axis: ParameterSet) -> list[Alarm]:
    return start_up(axis, "Z")


def ids(listed: Listed, number: int, *lines: str) -> list[int]:
    text = "\n".join([f"kenngr.antr_typ {number}", *lines, ""])
    return [warning.id for warning in started(listed(text))]


def test_the_numbers_are_those_that_the_parameter_takes() -> None:
    (row,) = [row for row in table("axis").parameters if row.path == DRIVE_TYPE]
    assert [int(word) for word in row.values] == list(DRIVE_TYPES)
    words = row.meaning.partition(": ")[2].partition(". ")[0].split("; ")
    assert words == [f"{number} {kind.name}" for number, kind in DRIVE_TYPES.items()]


def test_a_family_has_its_folder_in_the_rooms_of_drives() -> None:
    for number in SIMULATED:
        family = DRIVE_TYPES[number].family
        for room in ("axisrig.kernel.drives", "axisrig.bench.drive"):
            assert find_spec(f"{room}.{family}") is not None, room
    assert SIMULATED == (1, 2, 3, 5, 6, 8)


@pytest.mark.parametrize("number", DRIVE_TYPES)
def test_a_type_that_nobody_has_says_why(number: int) -> None:
    assert bool(DRIVE_TYPES[number].why) is (number not in SIMULATED)


@pytest.mark.parametrize("number", DRIVE_TYPES)
def test_distance_control_and_the_input_of_edge_banding(listed: Listed, number: int) -> None:
    """FCT-M3 2: SERCOS, PROFIdrive and CANopen; P-AXIS-00539: the first two."""
    on = ids(listed, number, "lr_param.distance_control_on 1")
    assert on == ([] if number in (2, 3, 8) else [110547])
    banding = ids(listed, number, "kenngr.measure.input_edge_banding 1")
    assert banding == ([] if number in (2, 3) else [110614])


@pytest.mark.parametrize("number", DRIVE_TYPES)
def test_the_second_input_of_a_drive_that_has_one(listed: Listed, number: int) -> None:
    """P-AXIS-00517 and 00583. External hardware has as many inputs with each type."""
    has_two = number in (2, 3, 8)
    assert ids(listed, number, "kenngr.measure.input 2") == ([] if has_two else [110622])
    assert ids(listed, number, "kenngr.measure.probe[1].input 2") == ([] if has_two else [110622])
    external = ("kenngr.measure.signal PLC_EXT_LATCH_CONTROL", "kenngr.measure.input 255")
    assert ids(listed, number, *external) == []
    axis = listed(f"kenngr.antr_typ {number}\nkenngr.measure.input 2\n")
    started(axis)
    assert axis.integer("kenngr.measure.input") == (2 if has_two else 1)


@pytest.mark.parametrize("number", DRIVE_TYPES)
def test_a_terminal_latches_at_rising_edges_only(listed: Listed, number: int) -> None:
    """FCT-C4 6.3; where the PLC gives the signal the drive does not matter."""
    falling = f"kenngr.antr_typ {number}\nkenngr.measure.edge NEG\n"
    assert started(listed(f"{falling}kenngr.measure.signal PLC\n")) == []
    assert ids(listed, number, "kenngr.measure.edge POS") == []
    if number != 6:
        assert started(listed(falling)) == []
        return
    with pytest.raises(UserError, match="type terminal does not latch at this edge") as caught:
        started(listed(falling))
    assert (caught.value.line, caught.value.allowed) == (2, "POS")


@pytest.mark.parametrize("number", DRIVE_TYPES)
def test_older_switches_of_the_printed_table(listed: Listed, number: int) -> None:
    """FCT-C4 8.2.4, P-AXIS-00115: no measuring by SERCOS with a simulated or conventional drive."""
    for switch in ("achs_steuer", "sercos", "taster"):
        lacks = switch == "sercos" and number in (1, 4)
        axis = listed(f"kenngr.antr_typ {number}\nkenngr.mess_signal_{switch} 1\n")
        assert [warning.id for warning in started(axis)] == ([900740] if lacks else [])
        assert axis.flag(f"kenngr.mess_signal_{switch}") is not lacks


@pytest.mark.parametrize("number", DRIVE_TYPES)
def test_the_newer_lag_limit_of_a_fixed_stop(listed: Listed, number: int) -> None:
    """FCT-C4 8.2.2: P-AXIS-00331 is of six types, 00774 of those but conventional."""
    axis = listed(f"kenngr.antr_typ {number}\n{STOP} 50\nkenngr.fixed_stop_pos_lag_limit 70\n")
    assert [warning.id for warning in started(axis)] == ([900741] if number == 1 else [])
    assert axis.integer(STOP) == (70 if number == 1 else 50)


@pytest.mark.parametrize("number", DRIVE_TYPES)
def test_places_of_the_position_loop(listed: Listed, number: int) -> None:
    """TF5200 commissioning 436095115; DSC is of PROFIdrive; without a loop run spindles only."""
    allowed = {2: {DRIVE, CNC}, 3: {DRIVE, CNC, DSC}, 8: {DRIVE, CNC}}.get(number, {CNC})
    for mode in (DEFAULT, DRIVE, CNC, DSC, "OPEN_POSITION_LOOP_MODE"):
        axis = listed(f"kenngr.antr_typ {number}\nantr.operation_mode {mode}\n")
        found = [warning.id for warning in started(axis)]
        if mode in allowed | {DEFAULT}:
            assert (found, axis.word("antr.operation_mode")) == ([], mode)
        else:
            assert found == [110511 if mode.startswith("OPEN") else 110457]
            assert axis.word("antr.operation_mode") == DEFAULT


@pytest.mark.parametrize("number", DRIVE_TYPES)
def test_drive_functions_need_parameters_in_the_drive(listed: Listed, number: int) -> None:
    """TF5200 axis parameters 118089227: SERCOS, PROFIdrive, CANopen."""
    found = ids(listed, number, "antr.function[0].id TORQUE")
    assert found == ([] if number in (2, 3, 8) else [900742])


OPEN = "OPEN_POSITION_LOOP_MODE"


@pytest.mark.provokes(110622, 1, axis="Z", probe=0, wrong=2, corrected=1)
@pytest.mark.provokes(900740, 1, axis="Z", drive_type="conventional", number="P-AXIS-00116")
@pytest.mark.provokes(900741, 1, axis="Z", drive_type="conventional", value=50)
@pytest.mark.provokes(110457, 1, axis="Z", drive_type="conventional", wrong=DSC, corrected=DEFAULT)
@pytest.mark.provokes(900742, 1, axis="Z", drive_type="conventional", names="antr.function[0].id")
def test_a_conventional_drive_lacks_much_of_it(listed: Listed) -> None:
    lines = (
        "kenngr.measure.input 2", "kenngr.mess_signal_sercos 1", f"{STOP} 50",
        f"antr.operation_mode {DSC}", "antr.function[0].id TORQUE",
    )  # fmt: skip
    assert ids(listed, 1, *lines) == [900740, 110622, 900741, 110457, 900742]


@pytest.mark.provokes(
    110511, 1, axis="Z", drive_type="CANopen", wrong=OPEN,
    axis_type="ACHSTYP_TRANSLATOR", corrected=DEFAULT,
)  # fmt: skip
def test_an_axis_has_a_position_loop(listed: Listed) -> None:
    assert ids(listed, 8, f"antr.operation_mode {OPEN}") == [110511]
