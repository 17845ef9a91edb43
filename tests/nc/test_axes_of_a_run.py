"""Which axes of a measuring run have a result, and turned systems whose values are inches."""

import pytest
from tests.nc.conftest import PlaneMachine

from axisrig.kernel.errors import Alarm
from axisrig.kernel.nc.canon import LinearMove, Message


class Remembering(PlaneMachine):
    """Answers for an axis by its last run, as a channel does."""

    def __init__(self) -> None:
        super().__init__({"X": 0.0, "Y": 0.0, "Z": 0.0}, ("X", 5.0))
        self.last_mm: dict[str, float | None] = {}

    def execute(self) -> None:
        self.latched = {}
        super().execute()
        self.last_mm |= self.latched
        self.latched = dict(self.last_mm)


def texts(commands) -> list[str]:
    return [each.text for each in commands if isinstance(each, Message)]


RUN_OF_X = 'G100 X9 F100\n#MSG["%d %g", V.A.MERF.X, V.A.MESS.X]\n'


@pytest.mark.parametrize("named", [True, False])
def test_an_axis_that_is_named_and_does_not_move_loses_the_result_of_before(run, named) -> None:
    """It is at X5 since its own run; one that is not named keeps what it has."""
    second = f"G100 {'X5' if named else ''} Y9 F100\n"
    machine = Remembering()
    found = texts(run(f'{RUN_OF_X}{second}#MSG["%d", V.A.MERF.X]', machine))
    assert found == ["1 5", "0" if named else "1"]
    if named:
        with pytest.raises(Alarm) as caught:
            run(f'{RUN_OF_X}{second}#MSG["%g", V.A.MESS.X]', Remembering())
        assert caught.value.id == 900101
    else:
        assert texts(run(f'{RUN_OF_X}{second}#MSG["%g", V.A.MESS.X]', Remembering()))[-1] == "5"


def targets(commands) -> dict[str, float]:
    found: dict[str, float] = {}
    for each in commands:
        if isinstance(each, LinearMove):
            found |= each.target_mm
    return found


@pytest.mark.parametrize(("unit", "mm"), [("G71", 1.0), ("G70", 25.4)])
@pytest.mark.parametrize(
    ("angles", "expected"),
    [
        # lower = R upper for (0, 1, 0): Rx(90), Ry(90), Rz(90)
        ("90,0,0", {"X": 1.0, "Y": 2.0, "Z": 4.0}), ("0,90,0", {"X": 1.0, "Y": 3.0, "Z": 3.0}),
        ("0,0,90", {"X": 0.0, "Y": 2.0, "Z": 3.0}),
    ],
)  # fmt: skip
def test_shifts_of_a_system_are_lengths_and_its_angles_are_none(
    run, unit, mm, angles, expected
) -> None:
    commands = run(f"{unit} G0\n#CS ON[1,2,3,{angles}]\nX0 Y1 Z0")
    found = {axis: targets(commands).get(axis, 0.0) for axis in "XYZ"}
    assert found == pytest.approx({axis: at * mm for axis, at in expected.items()}, abs=1e-9)
