"""Values out of range with a documented warning: ID, values, what is used then."""

from collections.abc import Callable
from pathlib import Path

import pytest

from axisrig.kernel.errors import Alarm, UserError
from axisrig.kernel.parameters import Kind, Origin, ParameterSet, read_list, start_up, write_list

Listed = Callable[..., ParameterSet]
Refused = Callable[..., UserError]

DETECT = "fixed_stop_detect.start_distance_per_mille"
BITS = "antr.sercos.probe_1_realtime_bits"


def started(parameters: ParameterSet) -> list[Alarm]:
    return start_up(parameters, "Z")


@pytest.mark.provokes(315000, 1, owner="axis Z", value_um_s=0, corrected_um_s=1)
@pytest.mark.provokes(110604, 1, owner="axis Z", value_um_s=-9, corrected_um_s=1)
@pytest.mark.provokes(315001, 1, owner="axis Z", value_mm_s2=-2, corrected_mm_s2=0)
@pytest.mark.provokes(315002, 1, owner="axis Z", value=100, high=99, corrected=99)
@pytest.mark.provokes(315003, 1, owner="axis Z", value_hz=-1.0, low_hz=0.0, corrected_hz=0.0)
@pytest.mark.provokes(315004, 1, owner="axis Z", value=7, low=0, high=6, corrected=6)
@pytest.mark.provokes(315005, 1, owner="axis Z", value=2000, high=1999, corrected=1999)
@pytest.mark.provokes(315008, 1, owner="axis Z", value=1.5, low=0.0, high=1.0, corrected=1.0)
@pytest.mark.provokes(315010, 1, owner="axis Z", value=2.5, low=0.0, high=2.0, corrected=2.0)
@pytest.mark.provokes(315011, 1, owner="axis Z", value_s=50.1, high_s=50.0, corrected_s=50.0)
@pytest.mark.provokes(315012, 1, owner="axis Z", value_s=-0.1, low_s=0.0, corrected_s=0.0)
@pytest.mark.parametrize(
    ("alarm_id", "line", "effective"),
    [
        (315000, "kenngr.dist_ctrl[0].v_max 0", 1),
        (110604, "kenngr.distc.v_max -9", 1),  # written in the older structure: the older ID
        (315001, "kenngr.dist_ctrl[0].a_max -2", 1000),  # 0 asks P-AXIS-00008
        (315002, "kenngr.dist_ctrl[0].n_cycles 100", 99),
        (315003, "kenngr.dist_ctrl[0].low_pass_filter_fg_f0 -1", 0.0),
        (315004, "kenngr.dist_ctrl[0].low_pass_filter_order 7", 6),
        (315005, "kenngr.dist_ctrl[0].v_weight_down 2000", 1999),
        (315008, "kenngr.dist_ctrl[0].smoothing_factor 1.5", 1.0),
        (315010, "kenngr.dist_ctrl[0].kp 2.5", 2.0),
        (315011, "kenngr.dist_ctrl[0].i_tn 50.1", 50.0),
        (315012, "kenngr.dist_ctrl[0].d_tv -0.1", 0.0),
    ],
)
def test_distance_control_of_an_axis_is_corrected_with_its_warning(
    listed: Listed, alarm_id: int, line: str, effective: float
) -> None:
    axis = listed(f"# first line\n{line}\n")
    (warning,) = started(axis)
    assert warning.id == alarm_id
    assert not warning.ends_program
    assert str(warning.place) == "list.lst:2"
    assert axis.get(line.split(maxsplit=1)[0]) == effective


@pytest.mark.parametrize(
    ("alarm_id", "name", "wrong", "effective"),
    [
        (315000, "v_max", "-1", 1),
        (315001, "a_max", "-1", 1),
        (315002, "n_cycles", "500", 99),
        (315003, "low_pass_filter_fg_f0", "-0.5", 0.0),
        (315004, "low_pass_filter_order", "9", 6),
        (315005, "v_weight_down", "5000", 1999),
        (315008, "smoothing_factor", "0", 0.001),
        (315010, "kp", "0", 0.001),
        (315011, "i_tn", "-1", 0.0),
        (315012, "d_tv", "2.01", 2.0),
    ],
)
def test_3d_distance_control_has_the_same_warnings_for_the_channel(
    listed: Listed, alarm_id: int, name: str, wrong: str, effective: float
) -> None:
    channel = listed(f"dist_ctrl[0].{name} {wrong}\nchannel_id 2\n", "channel")
    (warning,) = started(channel)
    assert warning.id == alarm_id
    assert warning.values["owner"] == "channel 2"
    assert channel.get(f"dist_ctrl[0].{name}") == effective


@pytest.mark.provokes(315001, 1, owner="channel 1", value_mm_s2=0, corrected_mm_s2=1)
def test_3d_distance_control_needs_an_acceleration_once_it_is_released(listed: Listed) -> None:
    released = listed("configuration.decoder.function FCT_3D_DIST_CTRL\n", "channel")
    assert [warning.id for warning in started(released)] == [315001]
    assert started(listed("messtyp 1\n", "channel")) == []


@pytest.mark.provokes(110757, 1, axis="Z", value_permille=1001, limit_permille=1000)
@pytest.mark.provokes(110658, 1, axis="Z", value_permille=2000, limit_permille=1000)
@pytest.mark.parametrize(
    ("alarm_id", "path", "value"),
    [
        (110757, f"kenngr.measure.{DETECT}", 1001),
        (110658, "antr.fixed_stop.detect.start_distance_per_mille", 2000),
    ],
)
def test_a_start_beyond_the_block_is_warned_of_and_stays(
    listed: Listed, alarm_id: int, path: str, value: int
) -> None:
    axis = listed(f"{path} {value}\n")
    (warning,) = started(axis)
    assert warning.id == alarm_id
    assert axis.integer(f"kenngr.measure.{DETECT}") == value


def test_the_id_of_the_seed_comes_before_the_newer_one(listed: Listed) -> None:
    (warning,) = started(listed(f"kenngr.measure.{DETECT} 1001\n"))
    assert (warning.id, warning.entry.newer_id) == (110757, 110657)


@pytest.mark.provokes(110547, 1, axis="Z", drive_type="Lightbus")
def test_distance_control_needs_a_drive_type_that_can_do_it(listed: Listed) -> None:
    axis = listed("kenngr.antr_typ 5\nlr_param.distance_control_on 1\n")
    assert [warning.id for warning in started(axis)] == [110547]
    assert axis.flag("lr_param.distance_control_on") is False
    for drive_type in (2, 3, 8):
        axis = listed(f"kenngr.antr_typ {drive_type}\nlr_param.distance_control_on 1\n")
        assert started(axis) == []
        assert axis.flag("lr_param.distance_control_on") is True


@pytest.mark.provokes(110586, 1, axis="Z", drive_type="simulation", wrong="DRIVE", corrected="PLC")
def test_a_simulated_drive_cannot_latch(listed: Listed) -> None:
    axis = listed("kenngr.antr_typ 4\nkenngr.measure.signal DRIVE\n")
    assert [warning.id for warning in started(axis)] == [110586]
    assert axis.word("kenngr.measure.signal") == "PLC"
    assert started(listed("kenngr.measure.signal DRIVE\n")) == []  # drives of a rig are CANopen


@pytest.mark.provokes(110608, 1, axis="Z", name="LATCHED")
@pytest.mark.provokes(110609, 1, axis="Z", value=0)
@pytest.mark.provokes(110610, 1, axis="Z", name="ACTUATED")
@pytest.mark.provokes(110613, 1, axis="Z", value=8)
@pytest.mark.provokes(110611, 1, axis="Z", value=5)
@pytest.mark.provokes(110612, 1, axis="Z", name="S-0-0135")
@pytest.mark.provokes(110617, 1, axis="Z", name="S-0-0135")
@pytest.mark.provokes(110618, 1, axis="Z", value=9)
@pytest.mark.parametrize(
    ("alarm_id", "line", "good"),
    [
        (110617, "antr.sercos.probing_command_start.element_name S-0-0135", "S-0-0134"),
        (110618, "antr.sercos.probing_command_start.bit_nr 9", "7"),
        (110608, f"{BITS}.value_latched.element_name LATCHED", "S_0_0135"),
        (110609, f"{BITS}.value_latched.bit_nr 0", "7"),
        (110610, f"{BITS}.probe_actuated.element_name ACTUATED", "S_0_135"),
        (110613, f"{BITS}.start_probing.bit_nr 8", "6"),
        (110611, f"{BITS}.probe_actuated.bit_nr 5", "6"),
        (110612, f"{BITS}.start_probing.element_name S-0-0135", "S-0-0134"),
    ],
)
def test_a_sercos_probe_configured_wrong_takes_the_axis_out_of_measuring(
    listed: Listed, alarm_id: int, line: str, good: str
) -> None:
    head = "kenngr.antr_typ 2\nkenngr.messachse 1\nkenngr.kasto_achse 1\n"
    axis = listed(f"{head}{line}\n")
    assert [warning.id for warning in started(axis)] == [alarm_id]
    assert not axis.flag("kenngr.messachse")
    assert not axis.flag("kenngr.kasto_achse")
    axis = listed(f"{head}{line.rpartition(' ')[0]} {good}\n")
    assert started(axis) == []
    assert axis.flag("kenngr.messachse")
    assert started(listed(f"kenngr.messachse 1\n{line}\n")) == []  # no SERCOS drive


@pytest.mark.provokes(110508, 3, axis="Z", id=2, wrong=1, corrected=0)
@pytest.mark.provokes(900640, 1, axis="Z", id=2)
def test_an_actual_value_transformation_takes_the_axis_out_of_measuring(listed: Listed) -> None:
    """Both that it is on and which one it is are wanted; an axis that does not measure keeps it."""
    measures, on = "kenngr.messachse 1\n", "trafo.actual_pos.enable 1\n"
    axis = listed(f"{measures}{on}trafo.actual_pos.id 2\n")
    assert [warning.id for warning in started(axis)] == [110508, 900640]
    assert not axis.flag("kenngr.messachse")
    assert [a.id for a in started(listed(f"{on}trafo.actual_pos.id 3\n"))] == [900640]
    for without in (f"{measures}{on}", f"{measures}trafo.actual_pos.id 1\n"):
        axis = listed(without)
        assert started(axis) == []
        assert axis.flag("kenngr.messachse")


@pytest.mark.provokes(110622, 1, axis="Z", probe=1, wrong=3, corrected=2)
def test_a_probe_input_that_the_drive_does_not_have_leaves_the_decision(listed: Listed) -> None:
    axis = listed("kenngr.measure.probe[1].input 3\nkenngr.measure.input 2\n")
    assert [warning.id for warning in started(axis)] == [110622]
    assert axis.integer("kenngr.measure.probe[1].input") == 2
    assert started(listed("kenngr.measure.probe[0].input 2\n")) == []
    external = "kenngr.measure.signal PLC_EXT_LATCH_CONTROL\nkenngr.measure.input 9\n"
    assert started(listed(f"{external}kenngr.measure.probe[0].input 0\n")) == []


@pytest.mark.provokes(110614, 1, axis="Z", drive_type="CANopen", wrong=2)
def test_only_some_drives_have_an_input_for_edge_banding(listed: Listed) -> None:
    assert started(listed("kenngr.measure.input_edge_banding 0\n")) == []
    text = "kenngr.measure.input_edge_banding 2\n"
    axis = listed(text)
    assert [warning.id for warning in started(axis)] == [110614]
    assert axis.integer("kenngr.measure.probe[1].input") == 1
    axis = listed(f"{text}kenngr.antr_typ 3\n")
    assert started(axis) == []
    assert axis.integer("kenngr.measure.probe[1].input") == 2


@pytest.mark.parametrize(
    ("text", "kind"),
    [
        ("kenngr.dist_ctrl[0].n_cycles -1", "axis"),
        ("kenngr.dist_ctrl[0].a_weight_down 2000", "axis"),
        ("kenngr.dist_ctrl[0].tolerance -1", "axis"),
        ("dist_ctrl[0].max_deviation -1", "channel"),
        ("dist_ctrl[0].kalman_sigma -1", "channel"),
    ],
)
def test_out_of_range_without_a_documented_warning_is_refused(
    refused: Refused, text: str, kind: Kind
) -> None:
    error = refused(f"\n{text}\n", kind)
    assert "outside its range" in error.message
    assert error.line == 2


@pytest.mark.parametrize(
    ("signal", "number", "is_good"),
    [("DRIVE", 2, True), ("DRIVE", 3, False), ("PLC_EXT_LATCH_CONTROL", 255, True),
     ("EXT_PROBE_WITH_DRIVE", 4, False), ("PLC", 9, True)],
)  # fmt: skip
def test_the_range_of_the_probing_input_follows_from_the_signal_source(
    listed: Listed, signal: str, number: int, *, is_good: bool
) -> None:
    axis = listed(f"kenngr.measure.input {number}\nkenngr.measure.signal {signal}\n")
    if is_good:
        assert started(axis) == []
        return
    with pytest.raises(UserError, match="has no such probing input") as caught:
        started(axis)
    assert caught.value.line == 1
    assert caught.value.allowed == "1 .. 2"


def test_a_corrected_value_is_written_and_read_without_a_warning(tmp_path: Path) -> None:
    axis = ParameterSet("axis")
    axis.load("kenngr.dist_ctrl[0].kp", "9", Origin("list.lst", 1))
    assert [warning.id for warning in started(axis)] == [315010]
    write_list(axis, tmp_path / "out.lst")
    again = read_list(tmp_path / "out.lst", "axis")
    assert started(again) == []
    assert again.get("kenngr.dist_ctrl[0].kp") == 2.0
