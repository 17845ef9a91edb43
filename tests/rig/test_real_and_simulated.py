"""What of a rig is simulated and what is real: axes, plants, sensors; and what may not be both."""

from collections.abc import Callable
from functools import partial

import pytest

from axisrig.bench.rig.real_axes import (
    check_outside,
    is_paced,
    is_real,
    outside_axes,
    simulated_plants,
)
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.errors import UserError

REAL = '[segment.can1]\ninterface = "socketcan"\nchannel = "can0"\n'
Make = Callable[..., Settings]


@pytest.fixture
def make(rig_above: Make) -> Make:
    """Return `make(TOML above X, Y, Z on a bus each, *assignments)`."""
    return partial(rig_above, "probe-xyz.toml")


OWN = '[plant.other]\nfmu = "AxisRig.Sensors.TouchProbe"\nwire = { z = "z" }\n'


@pytest.mark.parametrize(
    ("text", "outside", "plants"),
    [
        ("", "", ["x", "y", "z", "probe"]),
        # The probe reads the axis that is away, the other one does not
        (REAL + OWN, "X", ["y", "z", "other"]),
        (f"{REAL}[axis.X]\noutside = false", "", ["x", "y", "z", "probe"]),
        (f"{REAL}[axis.X]\noutside = true", "X", ["y", "z"]),
        (REAL + REAL.replace("can1", "can3"), "XZ", ["y"]),
    ],
)
def test_an_axis_on_a_real_bus_takes_its_plant_and_who_reads_it_away(
    make: Make, text: str, outside: str, plants: list[str]
) -> None:
    settings = make(text)
    assert outside_axes(settings) == frozenset(outside)
    assert list(simulated_plants(settings)) == plants
    assert is_paced(settings) is bool(text)  # a real segment runs in real time, whoever is on it
    assert is_real(settings, "can1") is bool(text)
    assert not is_real(settings, "can2")


def test_without_a_kernel_every_drive_is_simulated(make: Make) -> None:
    """For the master of somebody else."""
    settings = make(REAL)
    settings.has_kernel = False
    assert (outside_axes(settings), len(simulated_plants(settings))) == (frozenset(), 4)
    own = make("[axis.Y]\noutside = true")
    own.has_kernel = False
    check_outside(own)  # what the rig says of the drive is for a kernel


@pytest.mark.parametrize(
    ("text", "changes", "words"),
    [
        ("[axis.Y]\noutside = true", (), "axis Y cannot have a real drive: segment can2 is"),
        (REAL, (), "axis Y: probe reads an axis outside, so it is not simulated"),
        ("", ("fault:drop=X.TPDO1",), None),
        (f"{REAL}[axis.X]\noutside = false", ("fault:drop=X.TPDO1",), "faults are simulated"),
        (f"{REAL}[axis.X]\noutside = false", (), None),
        ("", ("plant:x.position_start_mm=5",), None),
    ],
)
def test_what_needs_a_simulation_and_is_real_is_refused(
    make: Make, text: str, changes: tuple[str, ...], words: str | None
) -> None:
    settings = make(text, *changes)
    if words is None:
        check_outside(settings)
        return
    with pytest.raises(UserError) as caught:
        check_outside(settings)
    assert caught.value.message.startswith(words)


def test_a_start_value_of_a_plant_that_is_away_is_refused_with_its_place(make: Make) -> None:
    """Y and Z have a probe of their own here, so that nothing else is wrong."""
    text = REAL + OWN.replace('z = "z"', 'y = "y", z = "z"')
    text += '[axis.Y]\nprobe_1 = "other"\nprobe_2 = "other"\n'
    text += '[axis.Z]\nprobe_1 = "other"\nprobe_2 = "other"\n'
    check_outside(make(text, "plant:z.position_start_mm=5"))
    for plant in ("x", "probe"):
        with pytest.raises(UserError) as caught:
            check_outside(make(text, f"plant:{plant}.position_start_mm=5"))
        shown = str(caught.value)
        assert f"plant:{plant}.position_start_mm=5" in shown
        assert f"{plant} is not simulated: it belongs to a drive outside" in shown
