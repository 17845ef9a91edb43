"""#MEAS: input, edge and source of the signal, as the drives have them."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from axisrig.kernel.errors import Alarm

Make = Callable[..., Any]
INCREMENT_MM = 10 / 2**20


@pytest.mark.provokes(50637, 4, axis="Z")
def test_50637_for_settings_of_an_axis_that_does_not_measure(
    channel_bench: Make, words: Any
) -> None:
    bench = channel_bench(words.axis("Z", start_mm=130.0, may_measure=False))
    bench.run([words.probe_settings(1, "Z", edge="NEG"), words.end()])
    (alarm,) = bench.channel.alarms
    assert (alarm.id, alarm.entry.reaction_class, alarm.values) == (50637, 4, {"axis": "Z"})


@pytest.mark.parametrize(
    ("settings", "values"),
    [
        ({"edge": "NEG"}, {"axis": "Z", "input": 1, "edge": "NEG", "object": "0x60BB"}),
        ({"probe_input": 2}, {"axis": "Z", "input": 2, "edge": "POS", "object": "0x60BC"}),
    ],
)
@pytest.mark.provokes(900223, 4, axis="Z")
def test_900223_for_a_latch_that_is_not_mapped(
    channel_bench: Make, words: Any, settings: dict[str, Any], values: dict[str, Any]
) -> None:
    bench = channel_bench(words.axis("Z", start_mm=130.0), plane_mm=120.0)
    bench.run(
        [
            words.probe_settings(1, "Z", **settings),
            words.probe(2, 600.0, Z=110.0),
            words.wait(2),
            words.end(),
        ]
    )
    (alarm,) = bench.channel.alarms
    assert (alarm.id, alarm.entry.reaction_class, alarm.values) == (900223, 4, values)


MAP = """pdo,transmission,inhibit_100us,index,sub,bits,signed,field
RPDO1,1,0,0x6040,0,16,no,controlword
RPDO1,1,0,0x607A,0,32,yes,target
RPDO1,1,0,0x60B8,0,16,no,probe_function
TPDO1,1,0,0x6041,0,16,no,statusword
TPDO1,1,0,0x6064,0,32,yes,actual
TPDO1,1,0,0x60B9,0,16,no,probe_status
TPDO2,1,0,latch,0,32,yes,latch
TPDO2,1,0,0x60BB,0,32,yes,
TPDO3,254,10,0x60FD,0,32,no,inputs
"""


@pytest.mark.long
def test_both_edges_of_one_probe_when_both_latches_are_mapped(
    channel_bench: Make, words: Any, tmp_path: Path
) -> None:
    """Down through the plane the input rises, up again it falls; then down once more."""
    table = tmp_path / "map.csv"
    table.write_text(MAP, encoding="utf-8")
    bench = channel_bench(words.axis("Z", start_mm=130.0), plane_mm=120.0, pdo_map=str(table))
    bench.run(
        [
            words.probe(1, 600.0, Z=110.0),
            words.probe_settings(2, "Z", edge="NEG"),
            words.probe(3, 1200.0, Z=130.0),
            words.probe_settings(4, "Z", edge="POS"),
            words.probe(5, 600.0, Z=110.0),
            words.end(),
        ]
    )
    assert bench.alarm_ids == []
    values = [record.latched_mm["Z"] for record in bench.channel.records]
    assert values == pytest.approx([120.0] * 3, abs=INCREMENT_MM)


def test_the_edge_in_use_decides_what_an_actuated_probe_is(
    channel_bench: Make, words: Any, tmp_path: Path
) -> None:
    """Above the plane the input is low: actuated for the falling edge (50052)."""
    table = tmp_path / "map.csv"
    table.write_text(MAP, encoding="utf-8")
    bench = channel_bench(words.axis("Z", start_mm=130.0), plane_mm=120.0, pdo_map=str(table))
    run = words.probe(2, 600.0, Z=110.0)
    bench.run([words.probe_settings(1, "Z", edge="NEG"), run, words.end()])
    assert bench.alarm_ids == [50052]


@pytest.mark.long
def test_an_input_that_is_chosen_alone_leaves_the_edge_chosen_before(
    channel_bench: Make, words: Any, tmp_path: Path
) -> None:
    """Up through the plane the input falls; for a rising edge the probe would be actuated."""
    table = tmp_path / "map.csv"
    table.write_text(MAP, encoding="utf-8")
    bench = channel_bench(words.axis("Z", start_mm=110.0), plane_mm=120.0, pdo_map=str(table))
    bench.run(
        [
            words.probe_settings(1, "Z", edge="NEG"),
            words.probe_settings(2, "Z", probe_input=1),
            words.probe(3, 1200.0, Z=130.0),
            words.wait(3),
            words.end(),
        ]
    )
    assert bench.alarm_ids == []
    assert bench.channel.measured_acs_mm("Z") == pytest.approx(120.0, abs=INCREMENT_MM)


def test_the_end_of_the_program_brings_back_what_the_list_says(
    channel_bench: Make, words: Any, tmp_path: Path
) -> None:
    table = tmp_path / "map.csv"
    table.write_text(MAP, encoding="utf-8")
    bench = channel_bench(words.axis("Z", source="PLC"), pdo_map=str(table))
    chosen = words.probe_settings(1, "Z", edge="NEG", source="DRIVE")
    bench.run([chosen, words.move(2, 600.0, Z=1.0), words.end()])
    assert (bench.alarm_ids, bench.links[0].edge) == ([], "POS")
    with pytest.raises(Alarm, match="900400"):  # the signal of the PLC again
        bench.channel.measurement.check("Z", 1)


@pytest.mark.long
@pytest.mark.provokes(900400, 2, axis="Z", source="PLC")
def test_signal_drive_of_meas_wins_over_the_parameter_list(channel_bench: Make, words: Any) -> None:
    run = words.probe(2, 600.0, Z=110.0)
    for source, alarms in ((None, [900400]), ("DRIVE", [])):
        bench = channel_bench(words.axis("Z", start_mm=130.0, source="PLC"), plane_mm=120.0)
        chosen = words.probe_settings(1, "Z", source=source)
        bench.run([chosen, run, words.wait(2), words.end()])
        assert bench.alarm_ids == alarms
    assert bench.channel.measured_acs_mm("Z") == pytest.approx(120.0, abs=INCREMENT_MM)


@pytest.mark.long
def test_probe0_and_probe1_stand_for_inputs_of_the_list(channel_bench: Make, words: Any) -> None:
    """Both are input 1 here (P-AXIS-00583)."""
    for probe in (0, 1):
        bench = channel_bench(words.axis("Z", start_mm=130.0), plane_mm=120.0)
        bench.run(
            [
                words.probe_settings(1, "Z", edge="POS", probe=probe),
                words.probe(2, 600.0, Z=110.0),
                words.wait(2),
                words.end(),
            ]
        )
        assert bench.channel.measured_acs_mm("Z") == pytest.approx(120.0, abs=INCREMENT_MM)
