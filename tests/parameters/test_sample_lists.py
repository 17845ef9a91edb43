"""Sample lists of the manuals: as printed they are refused with a hint, as meant they load.

The printed text has what text recognition made of it, and of the comments only what touches a
value. Expected values by hand.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import pytest

from axisrig.kernel.errors import UserError
from axisrig.kernel.parameters import Kind, ParameterSet, Value, read_sections, write_list
from axisrig.kernel.parameters.errata import errata, meant

Sections = Callable[..., list[ParameterSet]]


@dataclass(frozen=True)
class Sample:
    """A printed list; expected: what each of its parts holds, complete."""

    name: str
    printed: str
    expected: tuple[Mapping[str, Value], ...]
    kind: Kind = "axis"
    hints: tuple[str, ...] = field(default=())


FUNCTION_0 = {
    "antr.function[0].id": "MON_WINDOW",
    "antr.function[0].commu": "ACYCLIC",
    "antr.function[0].wr_ident[0]": "6065_00",
    "antr.function[0].data_type": "UNS32",
    "antr.function[0].scaling_type": "UNSCALED",
    "antr.function[0].scaling_factor": 1.0,
    "antr.function[0].min_limit": 0.0,
    "antr.function[0].max_limit": 4294967295.0,
    "antr.function[0].mask": "NOT_USED",
}
FUNCTION_1 = {
    "antr.function[1].id": "TORQUE_LIMIT",
    "antr.function[1].commu": "ACYCLIC",
    "antr.function[1].wr_ident[0]": "6072_00",
    "antr.function[1].data_type": "UNS16",
    "antr.function[1].scaling_type": "LINEAR",
    "antr.function[1].scaling_factor": 10.0,
    "antr.function[1].mask": "NOT_USED",
}
D = "dist_ctrl[0]"
K = "kenngr.dist_ctrl[0]"

SAMPLES = [
    Sample(
        "FCT-C4 3",
        "kenngr.messachse\t1\nkenngr.hub messtaster\t100000\nkenngr.vb messen\t10000\n"
        "kenngr.probing_offset\t0\nkenngr.measure.signal\tPLC\nkenngr.measure.input\t1\n"
        "kenngr.measure.edge\tPOS\n",
        (
            {
                "kenngr.messachse": True,
                "kenngr.hub_messtaster": 100000,
                "kenngr.vb_messen": 10000,
                "kenngr.probing_offset": 0,
                "kenngr.measure.signal": "PLC",
                "kenngr.measure.input": 1,
                "kenngr.measure.edge": "POS",
            },
        ),
        hints=("kenngr.hub_messtaster 100000",),
    ),
    Sample(
        "FCT-C4 4, two axes",
        "1\nkopf.achs nr\nkopf.log achs name                     X\nkenngr.messachse     1\n"
        "                                     2\nkopf.achs nr\n"
        "kopf.log achs name                     Y\nkenngr.messachse                     1\n",
        (
            {"kopf.achs_nr": 1, "kopf.log_achs_name": "X", "kenngr.messachse": True},
            {"kopf.achs_nr": 2, "kopf.log_achs_name": "Y", "kenngr.messachse": True},
        ),
    ),
    Sample(
        "FCT-C4 4, three axes",
        "#Konfiguration\nkopf.achs nr         1\nkopf.log achs name        X\n"
        "kenngr.messachse      1\nkopf.achs nr        2\nkopf.log achs name     Y\n"
        "kenngr.messachse     1\n                 3\nkopf.achs nr\n"
        "kopf.log_achs_name           Ζ\nkenngr.messachse       1\n".replace("Ζ", "Z"),
        (
            {"kopf.achs_nr": 1, "kopf.log_achs_name": "X", "kenngr.messachse": True},
            {"kopf.achs_nr": 2, "kopf.log_achs_name": "Y", "kenngr.messachse": True},
            {"kopf.achs_nr": 3, "kopf.log_achs_name": "Z", "kenngr.messachse": True},
        ),
        hints=("kopf.achs_nr 1",),
    ),
    Sample(
        "FCT-C4 6.1",
        "kenngr.hub\\_messtaster2000kenngr.vb\\_messen2000kenngr.messachse1"
        "kenngr.measure.signalDRIVEkenngr.echtzeit bit nr1\n",
        (
            {
                "kenngr.hub_messtaster": 2000,
                "kenngr.vb_messen": 2000,
                "kenngr.messachse": True,
                "kenngr.measure.signal": "DRIVE",
                "kenngr.echtzeit_bit_nr": 1,
            },
        ),
        hints=("kenngr.hub_messtaster 2000", "kenngr.echtzeit_bit_nr 1"),
    ),
    Sample(
        "FCT-C4 6.4",
        "kenngr.measure.edge NEG\nkenngr.measure.input 2\n"
        'antr.canopen.probing_trigger_source "DRIVE_DEFINED"\n',
        (
            {
                "kenngr.measure.input": 2,
                "kenngr.measure.edge": "NEG",
                "antr.canopen.probing_trigger_source": "DRIVE_DEFINED",
            },
        ),
    ),
    Sample(
        "FCT-C4 7.3, channel",
        "messtyp 7\nmeas_fixed_stop_no_error 1\n",
        ({"messtyp": 7, "meas_fixed_stop_no_error": True},),
        "channel",
    ),
    Sample(
        "Measuring to fixed stop",
        "   kenngr.measure.signal    FIXED_STOP\n",
        ({"kenngr.measure.signal": "FIXED_STOP"},),
    ),
    Sample(
        "FCT-C4 7.3.2",
        "antr.function[0].id    MON WINDOW\nantr.function[0].wr ident[0]     6065 00\n"
        "antr.function[0].commu   ACYCLIC\nantr.function[0].data type     UNS32\n"
        "antr.function[0].mask   NOT USED\nantr.function[0].scaling_type    UNSCALED\n"
        "antr.function[0].scaling_factor   1.0\nantr.function[0].min_limit     0.0\n"
        "antr.function[0].max limit     4294967295\nantr.function[1].id      TORQUE LIMIT\n"
        "antr.function[1].wr ident[0]     6072 00\nantr.function[1].commu    ACYCLIC\n"
        "antr.function[1].data type     UNS16\nantr.function[1].mask     NOT USED\n"
        "antr.function[1].scaling_type    LINEAR\nantr.function[1].scaling factor  10.0\n",
        ({**FUNCTION_0, **FUNCTION_1},),
        hints=("MON_WINDOW",),
    ),
    Sample(
        "FCT-C4 7.4",
        "kenngr.measure.signal PLC_EXT_LATCH_CONTROL\nkenngr.measure.input 4\n"
        "kenngr.measure.edge NEG\n",
        (
            {
                "kenngr.measure.signal": "PLC_EXT_LATCH_CONTROL",
                "kenngr.measure.input": 4,
                "kenngr.measure.edge": "NEG",
            },
        ),
    ),
    Sample(
        "FCT-C4 7.5",
        "kenngr.measure.signal PLC\\_TIMESTAMP\n",
        ({"kenngr.measure.signal": "PLC_TIMESTAMP"},),
    ),
    Sample(
        "FCT-C4 8.2.1",
        "meas_error_no_signal 1\nmeas_deceleration_mode 1\nmeas_use_std_dynamic 1\n",
        (
            {
                "meas_deceleration_mode": 1,
                "meas_use_std_dynamic": True,
                "meas_error_no_signal": True,
            },
        ),
        "channel",
    ),
    Sample(
        "FCT-M3 4.1",
        "kenngr.distc.filter_type MOVING_AVERAGE # ..\nkenngr.distc.n cycles 20 # .. # ..\n",
        ({f"{K}.n_cycles": 20, f"{K}.filter_type": "MOVING_AVERAGE"},),
        hints=("kenngr.distc.n_cycles 20",),
    ),
    Sample(
        "FCT-M3 4.2.1",
        "kenngr.distc.filter_type      EXPO_MEAN # ..\n"
        "kenngr.distc.n cycles 30 # ..\nvalues\n"
        "kenngr.distc.smoothing_factor 0.3       # ..\n",
        ({f"{K}.n_cycles": 30, f"{K}.filter_type": "EXPO_MEAN", f"{K}.smoothing_factor": 0.3},),
        hints=("kenngr.distc.n_cycles 30",),
    ),
    Sample(
        "FCT-M3 7.1",
        "kenngr.distc.mode dist use both encoder 1 # ..\n",
        ({f"{K}.mode_dist_use_both_encoder": True},),
        hints=("kenngr.distc.mode_dist_use_both_encoder 1",),
    ),
    Sample(
        "FCT-M3 7.3",
        "kenngr.distc.optimized_scheduling 1 # ..\n",
        ({f"{K}.optimized_scheduling": True},),
    ),
    Sample(
        "FCT-M3 12.8.3",
        "# P-CHAN-00500\nconfiguration.decoder.function         FCT_3D_DIST_CTRL\n"
        f"{D}.max_deviation             10000000\n{D}.v_max                     10000\n"
        f"{D}.a_max                     100\n{D}.max_act_value_change      10000000\n"
        f"{D}.v_weight_down             0\n{D}.a_weight_down              0\n"
        f"{D}.ref_offset                0\n{D}.max_pos                   1500000\n"
        f"{D}.min_pos                   -1500000\n{D}.tolerance                 0\n"
        "dist ctrl[0].kp 0.3# P-CHAN-00822\n"
        "dist ctrl[0].i tn 0.0# P-CHAN-00823\n"
        f"{D}.d_tv 0.01## Filter\n# P-CHAN-00800\n{D}.n_cycles                  20\n"
        f"dist ctrl[0].filter type \t MOVING AVERAGE\n{D}.smoothing_factor          0.05\n"
        f"{D}.kalman_sigma              2000\ndist ctrl[0].low pass filter order 3\n"
        "dist ctrl[0].low pass filter fg f0     50\n"
        f"dist ctrl[0].use adaptive acceleration 0\n{D}.a_min                     1\n"
        f"{D}.dist_error_a_min          400\n{D}.dist_error_a_max          2500\n",
        (
            {
                "configuration.decoder.function": "FCT_3D_DIST_CTRL",
                f"{D}.n_cycles": 20,
                f"{D}.max_deviation": 10_000_000,
                f"{D}.v_max": 10_000,
                f"{D}.a_max": 100,
                f"{D}.max_act_value_change": 10_000_000,
                f"{D}.ref_offset": 0,
                f"{D}.max_pos": 1_500_000,
                f"{D}.min_pos": -1_500_000,
                f"{D}.tolerance": 0,
                f"{D}.use_adaptive_acceleration": False,
                f"{D}.a_min": 1,
                f"{D}.dist_error_a_min": 400,
                f"{D}.dist_error_a_max": 2500,
                f"{D}.low_pass_filter_order": 3,
                f"{D}.low_pass_filter_fg_f0": 50.0,
                f"{D}.v_weight_down": 0,
                f"{D}.a_weight_down": 0,
                f"{D}.kp": 0.3,
                f"{D}.i_tn": 0.0,
                f"{D}.d_tv": 0.01,
                f"{D}.filter_type": "MOVING_AVERAGE",
                f"{D}.kalman_sigma": 2000.0,
                f"{D}.smoothing_factor": 0.05,
            },
        ),
        "channel",
        hints=(f"{D}.kp 0.3",),
    ),
    Sample(
        "TF5200 distance control 290233227",
        f"lr_param.distance_control_on 1\n{K}.max_abweichung 20000000 # [0.1um]\n"
        f".dist_ctrl[0].v_max 50000\n{K}.max_istw_sprung 100000000\n{K}.ref_offset 0\n"
        f"Kenngr.dist_ctrl[0].max_pos 1500000\n{K}.min_pos -1500000\n{K}.toleranz 50000\n"
        f"{K}.check_sw_limit_switch 1\n{K}.optimized_scheduling 1\n"
        f"{K}.mode_dist_use_both_encoder 1\n#{K}.use_adaptive_acceleration 1\n{K}.a_min 1000\n"
        f"{K}.a_max 10000 # [mm/s*s]\n{K}.dist_error_a_min 250\n{K}.dist_error_a_max 500\n"
        f"{K}.filter_type KALMAN_MA\n{K}.n_cycles 20\n",
        (
            {
                "lr_param.distance_control_on": True,
                f"{K}.n_cycles": 20,
                f"{K}.max_deviation": 20_000_000,
                f"{K}.v_max": 50_000,
                f"{K}.a_max": 10_000,
                f"{K}.max_act_value_change": 100_000_000,
                f"{K}.ref_offset": 0,
                f"{K}.max_pos": 1_500_000,
                f"{K}.min_pos": -1_500_000,
                f"{K}.tolerance": 50_000,
                f"{K}.check_sw_limit_switch": True,
                f"{K}.mode_dist_use_both_encoder": True,
                f"{K}.a_min": 1000,
                f"{K}.dist_error_a_min": 250,
                f"{K}.dist_error_a_max": 500,
                f"{K}.optimized_scheduling": True,
                f"{K}.filter_type": "KALMAN_MA",
            },
        ),
        hints=("kenngr.dist_ctrl[0].v_max",),
    ),
    Sample(
        "TF5200 external variables 294927371",
        "use_extended_string_var 0 # P-EXTV-00022\nanzahl_belegt 2\nvar[0].name FARBE\n"
        "var[0].type UNS16\nvar[0].synchronisation FALSE\nvar[0].array_elements 3\n"
        "var[1].name SENSOR (channel VE)\nvar[1].type REAL64\nvar[1].scope GLOBAL\n",
        (
            {
                "use_extended_string_var": False,
                "number_used_variables": 2,
                "var[0].name": "FARBE",
                "var[1].name": "SENSOR",
                "var[0].type": "UNS16",
                "var[1].type": "REAL64",
                "var[1].scope": "GLOBAL",
                "var[0].synchronisation": False,
                "var[0].array_elements": 3,
            },
        ),
        "external",
    ),
]
by_name = pytest.mark.parametrize("sample", SAMPLES, ids=lambda sample: sample.name)


@by_name
def test_a_sample_list_loads_as_it_was_meant(sections: Sections, sample: Sample) -> None:
    parts = sections(meant(sample.printed), sample.kind)
    assert [dict(part.items()) for part in parts] == list(map(dict, sample.expected))


@by_name
def test_a_sample_list_is_written_and_read_back_equal(
    sections: Sections, tmp_path: Path, sample: Sample
) -> None:
    parts = sections(meant(sample.printed), sample.kind)
    write_list(parts, tmp_path / "out.lst")
    again = read_sections(tmp_path / "out.lst", sample.kind)
    assert [list(part.items()) for part in again] == [list(part.items()) for part in parts]


@by_name
def test_a_damaged_sample_is_refused_with_what_is_meant(sections: Sections, sample: Sample) -> None:
    if meant(sample.printed).split() == sample.printed.split():  # nothing damaged
        sections(sample.printed, sample.kind)
        return
    with pytest.raises(UserError) as caught:
        sections(sample.printed, sample.kind)
    for hint in sample.hints:
        assert hint in str(caught.value.hint)


def test_every_erratum_is_one_of_these_samples() -> None:
    printed = [
        "\n" + "\n".join(" ".join(line.split()) for line in s.printed.splitlines()) + "\n"
        for s in SAMPLES
    ]
    unused = [row for row, _, _ in errata() if not any(f"\n{row}\n" in text for text in printed)]
    assert unused == []
    assert {source for _, _, source in errata()} <= {
        sample.name.partition(",")[0] for sample in SAMPLES
    }


def test_what_is_meant_is_not_damaged_itself(sections: Sections) -> None:
    for _, right, source in errata():
        kind = "channel" if right.startswith("dist_ctrl") else "axis"
        assert sections(f"{right}\n", kind), source
