"""What each drive type leaves of a list at its limits, and what the axes of a rig have to share."""

from collections.abc import Callable

import pytest

from axisrig.kernel.errors import UserError
from axisrig.kernel.parameters import ParameterSet, start_up
from axisrig.kernel.parameters.drive_types import DRIVE_TYPES
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
