"""3D distance control on a machine of one axis: as the control of that axis, and what is shown."""

import numpy as np
import pytest

from axisrig.bench.record.facts import read_run, run_text
from axisrig.kernel.distance import channel_objects

# The same numbers for the axis and for the channel
NUMBERS = {
    "max_deviation": 100000, "v_max": 20000, "a_max": 2000, "max_act_value_change": 10000000,
    "max_pos": 100000, "min_pos": -100000, "tolerance": 0, "kp": 0.3, "n_cycles": 6,
    "filter_type": "MOVING_AVERAGE", "optimized_scheduling": 1,
}  # fmt: skip
OF_AXIS = [f"set:Z.kenngr.dist_ctrl[0].{name}={value}" for name, value in NUMBERS.items()]
RELEASED = "set:channel.configuration.decoder.function=FCT_3D_DIST_CTRL"
OF_CHANNEL = [
    RELEASED, *(f"set:channel.dist_ctrl[0].{name}={value}" for name, value in NUMBERS.items())
]  # fmt: skip
VARIABLE = "SENSOR_SOURCE=VARIABLE SENSOR_VAR=V.E.SENSOR"
WHOLE = """G0 Z32
N10 #DIST CTRL [{sensor} MODE=ACS DIRECTION=Z]
N20 #DIST CTRL ON [{on}]
N30 G1 F3000 Z33
N40 #TIME 0.1
N50 #DIST CTRL WAIT OFF"""
OWN = """G0 Z32
N10 Z[DIST_CTRL {sensor}]
N20 Z[DIST_CTRL ON {on}]
N30 G1 F3000 Z33
N40 #TIME 0.1
N50 Z[DIST_CTRL WAIT OFF]"""


def program(text: str, on: str) -> str:
    return text.format(sensor=VARIABLE, on=on)


@pytest.mark.long
@pytest.mark.parametrize("on", ["CONST_DIST SET_DIST=1.5", "SET_POS=30.25"])
def test_acs_is_the_control_of_the_axis_bit_for_bit(run_distance, on):
    """The PLC gives -s to the axis, h to the channel; the frames to the drive are the same.

    WAIT OFF of the channel ends later: it waits for the last offset on its way.
    """
    own = run_distance(
        program(OWN, on), *OF_AXIS, newer=True, base="distance-z-variable.toml"
    ).outcome
    whole = run_distance(
        program(WHOLE, on), *OF_CHANNEL, base="distance-z-variable-gap.toml"
    ).outcome
    own_offsets = own.column("Z.offset_mm")
    rows = len(own_offsets)
    offsets = whole.column("channel.offset_mm")[:rows]
    assert np.abs(offsets).max() > 0.2
    assert rows <= len(whole.column("channel.offset_mm")) <= rows + 3
    assert np.array_equal(offsets, own_offsets)
    assert np.array_equal(whole.column("Z.set_mm")[:rows], own.column("Z.set_mm"))
    is_on = whole.column("channel.distance_state")[:rows] != 0
    is_on[np.argmax(is_on)] = False  # what is shown there is of before
    for name, sign in (("distance_cnc_mm", 1), ("surface_cnc_mm", 1), ("sensor_mm", -1)):
        assert np.array_equal(
            whole.column(f"channel.{name}")[:rows][is_on], sign * own.column(f"Z.{name}")[is_on]
        )
    assert np.abs(whole.column("Z.superposed_mm")[:rows] - offsets).max() < 1e-12


@pytest.mark.long
def test_objects_and_diagnosis_data_show_what_it_does(run_distance, tmp_path):
    """FCT-M3 12.6 in its units, and 12.10 with its names at every change and at the end."""
    read = {}

    def look(channel, cycle):
        found = channel.distance.channel
        if cycle == 120:
            for name, item in channel_objects().items():
                source = found.positions_of("Z") if item.of_axis else found
                read[name] = item.read(source)
            read["mm"] = (found.control.offset_mm, channel.links[0].actual_mm)

    watched = run_distance(
        program(WHOLE, "CONST_DIST SET_DIST=1.5"),
        *OF_CHANNEL,
        base="distance-z-variable-gap.toml",
        act=look,
    )
    offset_mm, actual_mm = read.pop("mm")
    assert list(read)[:2] == ["DIST_CTRL[0]::set_pos", "DIST_CTRL[0]::set_distance"]
    assert len(read) == 15
    assert read["DIST_CTRL[0]::set_distance"] == 150_000_000
    assert read["DIST_CTRL[0]::m_actual_offset"] == round(offset_mm * 1e8)
    assert read["DIST_CTRL[0]::sensor_value"] == pytest.approx((actual_mm - 30) * 1e8, abs=10_000)
    assert read["digital actual position"] == round(actual_mm * 1e4)
    with_offset = read["m_sollw_absolut"] + round(offset_mm * 1e4)
    assert read["sollw_absolut"] == pytest.approx(with_offset, abs=1)
    assert read["digital command position (high resolution)"] == pytest.approx(
        read["sollw_absolut"] * 1e4, abs=5e3
    )

    facts = watched.outcome.facts
    path = tmp_path / "run.json"
    path.write_text(run_text(facts), encoding="utf-8")
    kept = read_run(path).facts.distance_3d
    assert kept == facts.distance_3d
    assert kept.variable == "V.E.SENSOR"
    states = [dump.values["zstd"] for dump in kept.diagnosis]
    assert states[-2:] == ["INACTIVE(0)", "INACTIVE(0)"]
    on = next(d.values for d in kept.diagnosis if d.values["zstd"] == "ACTIVE_CONST_DIST(4)")
    assert list(on)[:5] == ["zstd", "tast_offset", "referenzwert", "sollw", "sollw_prog"]
    assert list(on)[-4:] == ["active_mode", "new_mode", "active_ax_idx", "new_ax_idx"]
    expected = {
        "sollw": "15000", "kp": "0.300000", "filter_type": "MOVING_AVERAGE", "n_cycles": "6",
        "v_max": "200000", "a_max": "2000", "active_mode": "ACS(1)", "logged_events": "0",
    }  # fmt: skip
    assert {name: on[name] for name in expected} == expected


def test_before_anything_says_where_the_surface_is_the_trace_has_the_distance_alone(run_distance):
    """The tool rests 2 mm above the surface; -0.0 was shown until the first ON."""
    watched = run_distance(
        f"G0 Z32\nG4 0.01\n#DIST CTRL [{VARIABLE}]\nG4 0.01",
        *OF_CHANNEL,
        base="distance-z-variable-gap.toml",
    )
    sensor_mm = watched.outcome.column("channel.sensor_mm")
    known = ~np.isnan(sensor_mm)
    assert 10 <= known.sum() < len(known)
    assert sensor_mm[known] == pytest.approx(2.0, abs=1e-3)
    assert np.isnan(watched.outcome.column("channel.surface_cnc_mm")).all()


@pytest.mark.long
@pytest.mark.provokes(315001, 1, owner="channel 1")
def test_without_a_max_it_creeps_and_says_so(run_distance):
    values = [text for text in OF_CHANNEL if "a_max" not in text]
    watched = run_distance(
        program(WHOLE, "CONST_DIST SET_DIST=1.5").replace("N50 #DIST CTRL WAIT OFF", "M30"),
        *values,
        base="distance-z-variable-gap.toml",
    )
    assert [alarm.id for alarm in watched.channel.alarms] == [315001]
    # 1 mm/s2 in cycles of 1 ms; the last row is that of the end, which holds the offset
    steps = watched.outcome.column("channel.step_mm")[:-1]
    assert np.abs(np.diff(steps)).max() <= 1e-6 + 1e-12
    assert np.abs(steps).max() > 1e-4


@pytest.mark.provokes(21837, 2)
def test_a_rig_without_the_licence(run_distance):
    watched = run_distance(
        program(WHOLE, "SET_POS=30"),
        *OF_CHANNEL,
        rig="[channel]\ncutting_licence = false\n",
        base="distance-z-variable-gap.toml",
    )
    assert [alarm.id for alarm in watched.channel.alarms] == [21837]


@pytest.mark.long
def test_over_a_plant_with_its_own_kinematic_the_shift_is_the_foretold_one(run_distance):
    """A surface 1.5 mm above SET_POS, A -35, C 20, ECS: X -0.3592, Y 0.9870 (docs/distance-3d.md).

    The distance comes from the Modelica model of tool and surface: 80 cos 35 = 65.5322 mm with the
    TCP on the surface, 1.5 mm more after the offset, and the offset stays in NO_MOVE.
    """
    watched = run_distance(
        "V.G.WZ_AKT.L = 80\n#TRAFO ON\nG1 F3600 X0 Y0 Z0\nA-35 C20\n"
        f"#DIST CTRL [{VARIABLE}]\n#TIME 0.1\n"
        '#MSG ["%.1f", V.E.SENSOR]\n'
        "#DIST CTRL ON [SURFACE SET_POS=-1.5 MODE=ECS]\n#TIME 1\n"
        '#MSG ["%.1f", V.E.SENSOR]\n'
        "#DIST CTRL WAIT [OFF NO_MOVE]\n"
        '#MSG ["%.6f %.6f %.6f", V.A.ABS.X, V.A.ABS.Y, V.A.ABS.Z]\n'
        "G1 X0 Y0 Z0\n#DIST CTRL ON [CONST_DIST SET_DIST=80 MODE=MCS]\nG1 A0\n#TIME 0.3\n"
        '#MSG ["%.6f %.1f", V.A.ABS.Z, V.E.SENSOR]\n'
        "#DIST CTRL WAIT OFF",
        base="distance-5axis.toml",
    )
    assert watched.channel.alarms == []
    on_surface, above, shift, level = (m.values for m in watched.outcome.facts.messages)
    distance = 800_000 * np.cos(np.radians(35))
    assert on_surface == pytest.approx((distance,), abs=2)  # 0.1 um; an increment of A is 0.8
    assert above == pytest.approx((distance + 15_000,), abs=2)
    assert shift == pytest.approx((-0.3592, 0.9870, 1.5), abs=1e-4)
    assert level == pytest.approx((0.0, 800_000), abs=2)
