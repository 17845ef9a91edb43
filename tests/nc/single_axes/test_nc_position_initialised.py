"""Where axes stand becomes what was programmed: G74, #CALL AX, #CHANNEL INIT, #DISABLE AX LINK."""

from collections.abc import Callable
from typing import Any

import pytest

from axisrig.kernel.nc import canon
from axisrig.kernel.nc.coordinates import Coordinates, Frame

Run = Callable[..., Any]
SHOW = '#MSG ["%g %g %g", V.A.PROG.Z, V.A.ABS.Z, V.A.ACT_POS.Z]\n'


def shown(commands: list[canon.Command]) -> list[tuple[float, ...]]:
    """PROG, ABS and ACT_POS of every message."""
    texts = [c.text for c in commands if isinstance(c, canon.Message)]
    return [tuple(float(part) for part in text.split()) for text in texts]


@pytest.fixture
def machine(plane_machine: Any) -> Any:
    """Z ends up at 100.02 mm whenever it homes or its actual position becomes the set one."""

    class Machine(plane_machine):
        def execute(self) -> None:
            orders = list(self.queue)
            super().execute()
            for order in orders:
                if isinstance(order, canon.Homing | canon.AdoptActual | canon.AxisExchange):
                    self.acs_mm["Z"] = 100.02

    return Machine(dict.fromkeys(("X", "Y", "Z"), 0.0), None)


@pytest.mark.parametrize(
    "command", ["G74 Z1", "#CHANNEL INIT[ACTPOS]", "#CALL AX[Z,3,2]"], ids=["G74", "INIT", "CALL"]
)
def test_prog_is_the_programmed_coordinate_of_where_the_axis_stands(
    run: Run, machine: Any, command: str
) -> None:
    """G92 Z5: 3 is 8; at 100.02 the programmed coordinate is 95.02."""
    put = "N30 #PUT AX[Z]\n" if "CALL" in command else ""
    text = f"%t\nN10 G92 Z5\nN20 G1 Z3 F600\n{SHOW}{put}N40 {command}\n{SHOW}N50 M30\n"
    before, after = shown(run(text, machine))
    assert before == (3.0, 8.0, 3.0)
    assert after == pytest.approx((95.02, 100.02, 95.02))


def test_a_shift_that_no_block_has_taken_yet_is_not_in_it(run: Run, machine: Any) -> None:
    """G92 acts with the next absolute programming; V.A.PROG and V.A.ACT_POS agree about that."""
    text = f"%t\nN20 G1 Z3 F600\nN30 G92 Z5\nN40 G74 Z1\n{SHOW}N50 M30\n"
    assert shown(run(text, machine)) == [(100.02, 100.02, 100.02)]


def test_a_slave_that_is_let_go_stands_where_its_master_has_led_it(run: Run, machine: Any) -> None:
    class Coupled(type(machine)):
        def execute(self) -> None:
            super().execute()
            self.acs_mm["A"] = self.acs_mm["Z"]

    coupled = Coupled(dict.fromkeys(("X", "Y", "Z", "A"), 0.0), None)
    text = (
        "%t\nN10 #SET AX LINK[1, A=Z]\nN20 #ENABLE AX LINK[1]\nN30 G1 Z7 F600\n"
        '#DISABLE AX LINK[1]\n#MSG ["%g %g", V.A.PROG.A, V.A.ABS.A]\nN50 M30\n'
    )
    assert shown(run(text, coupled, axes=("X", "Y", "Z", "A"))) == [(7.0, 7.0)]


def test_after_a_run_prog_stays_what_was_programmed(run: Run, plane_machine: Any) -> None:
    """MOFFS = MESS - PROG: programmed -20, touched at -15."""
    machine = plane_machine(dict.fromkeys(("X", "Y", "Z"), 0.0), ("Z", -15.0))
    text = f"%t\nN10 G100 Z-20 F600\n{SHOW}N50 M30\n"
    assert shown(run(text, machine)) == [(-20.0, -15.0, -15.0)]


def test_in_a_turned_system_all_main_axes_begin_anew() -> None:
    """Turned by 90 degrees about Z: the axis X is -Y of the program."""
    coordinates = Coordinates(("X", "Y", "Z"), dict.fromkeys("XYZ", 0.0))
    coordinates.switch_on(Frame.of([0, 0, 0, 0, 0, 90]))
    coordinates.aim({"X": 1.0, "Y": 2.0}, absolute=True)
    coordinates.begin_at({"X": 10.0})
    found = [coordinates.programmed_mm(axis) for axis in "XYZ"]
    assert found == pytest.approx([1.0, -10.0, 0.0])
