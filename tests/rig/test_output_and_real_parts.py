"""How much of the output of FMUs is kept, and what is refused of parts that are not simulated."""

from collections.abc import Callable
from pathlib import Path

import pytest

from axisrig.bench.rig.fmu_output import BYTES_MAX, cut, lines_in, output_lines
from axisrig.bench.rig.real_axes import check_outside
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.errors import UserError

Make = Callable[..., Settings]
REAL = '[segment.can1]\ninterface = "socketcan"\nchannel = "can0"\n'


@pytest.mark.parametrize("count", [0, 1, 19, 20, 21, 45])
def test_of_the_output_of_an_fmu_the_first_20_lines_are_shown_and_the_others_counted(
    count: int,
) -> None:
    found = output_lines("plant z", [f"line {number}" for number in range(count)])
    expected = [f"plant z wrote to standard output: line {n}" for n in range(min(count, 20))]
    if count > 20:
        expected.append(f"plant z wrote {count - 20} more lines to standard output")
    assert found == expected


def test_a_line_of_an_fmu_has_200_characters_that_can_be_printed(tmp_path: Path) -> None:
    """Blank lines are none, and what is no text does not keep the others away."""
    file = tmp_path / "out"
    file.write_bytes(b"a" * 200 + b"\n" + b"b" * 201 + b"\n\n  \t\nl\xc3\xa4nger\n\xff\nlast")
    first, second, third, fourth, last = lines_in(file)
    assert (first, second) == ("a" * 200, "b" * 200)
    assert third == "l\u00e4nger"
    assert fourth == "\ufffd"  # U+FFFD stands for what is no UTF-8
    assert last == "last"
    assert lines_in(tmp_path / "none") == []


@pytest.mark.parametrize("more", [-1, 0, 1, BYTES_MAX])
def test_a_file_of_output_is_cut_at_its_largest_size(tmp_path: Path, more: int) -> None:
    file = tmp_path / "out"
    file.write_bytes(b"x" * (BYTES_MAX + more))
    cut(file)
    assert file.stat().st_size == BYTES_MAX + min(more, 0)
    cut(tmp_path / "none")  # of a process that has written nothing yet


def test_lines_behind_the_largest_size_are_not_read(tmp_path: Path) -> None:
    file = tmp_path / "out"
    file.write_bytes(b"first\n" + b"\n" * (BYTES_MAX - 6) + b"behind\n")
    assert lines_in(file) == ["first"]


# --- what is real ------------------------------------------------------------------------------


def test_faults_on_a_real_bus_are_named_by_kind_each_once(rig_above: Make) -> None:
    settings = rig_above(
        "probe-xyz.toml", f"{REAL}[axis.X]\noutside = false",
        "fault:delay=X.TPDO1", "fault:drop=Y.TPDO1; Z.TPDO1", "fault:delay=Z.TPDO1",
    )  # fmt: skip
    with pytest.raises(UserError, match="this rig has a real bus") as caught:
        check_outside(settings)
    assert caught.value.value == "delay, drop"
    assert "leave the fault: columns" in str(caught.value.hint)


def test_an_axis_that_cannot_be_real_says_what_its_segment_needs(rig_above: Make) -> None:
    settings = rig_above("probe-xyz.toml", "[axis.Y]\noutside = true")
    with pytest.raises(UserError) as caught:
        check_outside(settings)
    error = caught.value
    assert error.hint == "give segment can2 an interface and a channel"
    assert (Path(str(error.file)).name, error.line) == ("rig.toml", 3)


@pytest.mark.parametrize("key", ["probe_1", "probe_2", "encoder_2"])
def test_a_sensor_of_an_axis_that_is_away_is_refused_where_it_is_named(
    rig_above: Make, key: str
) -> None:
    """`other` reads X, which has a real drive; Y and Z have a probe of their own."""
    text = REAL + '[plant.own]\nfmu = "AxisRig.Sensors.TouchProbe"\nwire = { y = "y", z = "z" }\n'
    text += '[plant.other]\nfmu = "AxisRig.Sensors.TouchProbe"\nwire = { x = "x" }\n'
    text += '[axis.Z]\nprobe_1 = "own"\nprobe_2 = "own"\n[axis.Y]\n'
    keys = {"probe_1": "own", "probe_2": "own"} | {key: "other"}
    text += "".join(f'{name} = "{plant}"\n' for name, plant in keys.items())
    settings = rig_above("probe-xyz.toml", text)
    with pytest.raises(UserError, match="axis Y: other reads an axis outside") as caught:
        check_outside(settings)
    error = caught.value
    line = Path(str(error.file)).read_text(encoding="utf-8").splitlines()[(error.line or 0) - 1]
    assert (error.value, line) == ("other", f'{key} = "other"')


def test_of_several_start_values_of_a_plant_that_is_away_the_first_is_named(
    rig_above: Make,
) -> None:
    text = REAL + '[plant.own]\nfmu = "AxisRig.Sensors.TouchProbe"\nwire = { y = "y", z = "z" }\n'
    text += "".join(f'[axis.{axis}]\nprobe_1 = "own"\nprobe_2 = "own"\n' for axis in "YZ")
    values = ("plant:y.kv=30", "plant:x.position_start_mm=5", "plant:x.kv=30")
    with pytest.raises(UserError, match="x is not simulated") as caught:
        check_outside(rig_above("probe-xyz.toml", text, *values))
    assert caught.value.message.startswith("--set plant:x.position_start_mm=5: ")
    assert caught.value.value == "5"
    assert "leave the cell empty" in str(caught.value.hint)
