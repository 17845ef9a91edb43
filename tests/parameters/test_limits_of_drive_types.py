"""What each drive type leaves of a list at its limits, and what the axes of a rig have to share."""

from collections.abc import Callable

import pytest
from tests.parameters.test_signal_sources import TO_A_STOP, WITHOUT_LATCH

from axisrig.kernel.errors import UserError
from axisrig.kernel.parameters import ParameterSet, start_up
from axisrig.kernel.parameters.drive_types import DRIVE_TYPES
from axisrig.kernel.parameters.signal_sources import SOURCES
from axisrig.kernel.parameters.start_up import OPTIMISED, equal_schedule

Listed = Callable[..., ParameterSet]
EVERY_TYPE = pytest.mark.parametrize("number", sorted(DRIVE_TYPES))


def ids(parameters: ParameterSet) -> list[int]:
    return [alarm.id for alarm in start_up(parameters, "Z")]


@EVERY_TYPE
@pytest.mark.parametrize("probe", [0, 1])
def test_a_probe_has_the_inputs_of_its_drive_and_no_more(
    listed: Listed, number: int, probe: int
) -> None:
    most, path = DRIVE_TYPES[number].inputs, f"kenngr.measure.probe[{probe}].input"
    for wanted in range(1, most + 2):
        axis = listed(f"kenngr.antr_typ {number}\n{path} {wanted}\n")
        found = ids(axis)
        assert (110622 in found) is (wanted > most)
        if wanted <= most:
            assert axis.integer(path) == wanted


@EVERY_TYPE
@pytest.mark.parametrize("edge", ["POS", "NEG"])
def test_an_edge_is_refused_where_the_drive_latches_and_does_not_know_it(
    listed: Listed, number: int, edge: str
) -> None:
    kind = DRIVE_TYPES[number]
    for signal in ("DRIVE", "PLC"):
        text = f"kenngr.antr_typ {number}\nkenngr.measure.signal {signal}\n"
        axis = listed(f"{text}kenngr.measure.edge {edge}\n")
        is_refused = signal == "DRIVE" and kind.latch and edge not in kind.edges
        if is_refused:
            with pytest.raises(UserError, match="does not latch at this edge"):
                ids(axis)
        else:
            ids(axis)
            assert axis.word("kenngr.measure.edge") == edge


@EVERY_TYPE
def test_the_newer_lag_limit_is_taken_away_where_the_drive_finds_stops_without_it(
    listed: Listed, number: int
) -> None:
    kind, path = DRIVE_TYPES[number], "kenngr.measure.fixed_stop_detect.pos_lag_limit"
    axis = listed(f"kenngr.antr_typ {number}\n{path} 500\n")
    is_corrected = bool(kind.fixed_stop) and "00774" not in kind.fixed_stop
    assert (900741 in ids(axis)) is is_corrected
    assert axis.integer(path) == (0 if is_corrected else 500)  # 0: as P-AXIS-00331


@pytest.mark.parametrize(
    ("having", "warned"),
    [
        ({}, []), ({"X": True}, []), ({"X": False}, []), ({"X": True, "Y": True}, []),
        ({"X": False, "Y": False}, []), ({"X": True, "Y": False, "Z": True}, ["X, Z", "Y"]),
    ],
)  # fmt: skip
def test_70212_takes_the_optimised_access_from_all_where_one_lacks_it(
    listed: Listed, having: dict[str, bool], warned: list[str]
) -> None:
    axes = {name: listed(f"{OPTIMISED} {int(has)}\n") for name, has in having.items()}
    found = equal_schedule(axes)
    assert [alarm.id for alarm in found] == [70212] * bool(warned)
    if warned:
        assert [found[0].values["axes"], found[0].values["others"]] == warned
    after = {name: axis.flag(OPTIMISED) for name, axis in axes.items()}
    assert after == (dict.fromkeys(having, False) if warned else having)


@EVERY_TYPE
@pytest.mark.parametrize("signal", SOURCES)
def test_a_source_that_the_type_does_not_have_is_named_and_becomes_the_plc(
    listed: Listed, number: int, signal: str
) -> None:
    """FCT-C4 8.2.2; warning 110586 has what was set, and a default is never warned of."""
    kind = DRIVE_TYPES[number]
    axis = listed(f"kenngr.antr_typ {number}\nkenngr.measure.signal {signal}\n")
    found = [alarm for alarm in start_up(axis, "Z") if alarm.id == 110586]
    wanted = {"axis": "Z", "drive_type": kind.name, "wrong": signal, "corrected": "PLC"}
    needs_latch, needs_stop = signal in ("DRIVE", "EXT_PROBE_WITH_DRIVE"), signal == "FIXED_STOP"
    lacks_it = number in WITHOUT_LATCH if needs_latch else needs_stop and number not in TO_A_STOP
    assert [alarm.values for alarm in found] == ([wanted] if lacks_it else [])
    assert axis.word("kenngr.measure.signal") == ("PLC" if lacks_it else signal)
    assert 110586 not in ids(listed(f"kenngr.antr_typ {number}\n"))


@EVERY_TYPE
def test_drive_functions_without_access_are_all_named(listed: Listed, number: int) -> None:
    names = ["antr.function[0].id", "antr.function[2].id", "antr.function[2].rd_ident"]
    text = "".join(f"{name} 1\n" for name in names)
    found = start_up(listed(f"kenngr.antr_typ {number}\n{text}"), "Z")
    named = [alarm.values["names"] for alarm in found if alarm.id == 900742]
    assert named == ([] if DRIVE_TYPES[number].access else [", ".join(names)])


@pytest.mark.parametrize(
    "axis_type", ["ACHSTYP_TRANSLATOR", "ACHSTYP_ROTATOR", "ACHSTYP_SPINDEL", "1", "2", "0x0004"]
)
def test_110511_names_the_type_of_the_axis_as_its_list_has_it(
    listed: Listed, axis_type: str
) -> None:
    mode = "OPEN_POSITION_LOOP_MODE"
    axis = listed(f"kenngr.achs_typ {axis_type}\nantr.operation_mode {mode}\n")
    (alarm,) = start_up(axis, "Z")
    assert (alarm.id, alarm.values["axis_type"], alarm.values["wrong"]) == (110511, axis_type, mode)


@pytest.mark.parametrize("wrong", [1, 2, 200])
def test_110614_names_the_input_that_was_set(listed: Listed, wrong: int) -> None:
    (alarm,) = start_up(listed(f"kenngr.measure.input_edge_banding {wrong}\n"), "Z")
    assert (alarm.id, alarm.values["wrong"]) == (110614, wrong)


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("kenngr.measure.input 2", (0, 2, 1)),
        ("kenngr.measure.probe[0].input 2", (0, 2, 1)),
        ("kenngr.measure.probe[1].input 7", (1, 7, 1)),
        ("antr.probing_input_nbr 2\nkenngr.measure.probe[1].input 9", (1, 9, 2)),
    ],
)
def test_110622_names_probe_and_input_and_what_then_counts(
    listed: Listed, text: str, values: tuple[int, int, int]
) -> None:
    """Of a drive with one input, and of one with two where a fallback decides."""
    number = 8 if "antr" in text else 1
    alarm = start_up(listed(f"kenngr.antr_typ {number}\n{text}\n"), "Z")[0]
    found = (alarm.values["probe"], alarm.values["wrong"], alarm.values["corrected"])
    assert (alarm.id, found) == (110622, values)
