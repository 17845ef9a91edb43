"""Which axes of a measuring run have a result: V.A.MERF and V.A.MESS of two runs in a row."""

import pytest
from tests.nc.conftest import PlaneMachine, texts

from axisrig.kernel.errors import Alarm


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
