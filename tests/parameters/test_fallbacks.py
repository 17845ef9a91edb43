"""Every fallback chain, each of its links set alone. By hand: FCT-C4 8.2.2, facts of the pages."""

from dataclasses import dataclass

import pytest

from axisrig.kernel.parameters import (
    KINDS,
    UNITS,
    Kind,
    Origin,
    Parameter,
    ParameterSet,
    Value,
    table,
)

STOP, DETECT = "kenngr.measure.fixed_stop_detect", "antr.fixed_stop.detect"
SLOPE, SHAPE = "getriebe[0].lslope_profil", "getriebe[0].slope_profil"


@dataclass(frozen=True)
class Chain:
    """links: path, a written value that decides, what then comes out. end: nothing is set."""

    links: tuple[tuple[str, str, Value], ...]
    end: Value
    kind: Kind = "axis"


CHAINS = [
    Chain(((f"{STOP}.pos_lag_limit", "7", 7), (f"{DETECT}.pos_lag_limit", "8", 8),
           ("kenngr.fixed_stop_pos_lag_limit", "9", 9)), 0),
    Chain(((f"{STOP}.min_time", "7", 7), (f"{DETECT}.min_time", "8", 8),
           ("kenngr.fixed_stop_nbr_cycles", "9", 9)), 0),
    Chain(((f"{STOP}.start_distance", "7", 7),), 0),
    Chain(((f"{STOP}.start_distance_per_mille", "7", 7),
           (f"{DETECT}.start_distance_per_mille", "8", 8)), -1),
    Chain(((f"{STOP}.max_delta_position_window", "7", 7),
           (f"{DETECT}.max_delta_position_window", "8", 8)), -1),
    Chain((("kenngr.measure.signal", "PLC_TIMESTAMP", "PLC_TIMESTAMP"),
           ("kenngr.meas_signal_fixed_stop", "1", "FIXED_STOP"),
           ("kenngr.probing_signal_via_plc", "1", "PLC"),
           ("kenngr.mess_signal_achs_steuer", "1", "PLC"),
           ("kenngr.meas_signal_drive", "1", "DRIVE"),
           ("kenngr.mess_signal_sercos", "1", "DRIVE"),
           ("kenngr.mess_signal_taster", "1", "DRIVE")), "DRIVE"),
    Chain((("kenngr.measure.input", "2", 2), ("antr.probing_input_nbr", "2", 2),
           ("antr.canopen.probing_input_number", "2", 2)), 1),
    Chain((("kenngr.measure.probe[0].input", "2", 2), ("kenngr.measure.input", "2", 2),
           ("antr.probing_input_nbr", "2", 2), ("antr.canopen.probing_input_number", "2", 2)), 1),
    Chain((("kenngr.measure.probe[1].input", "2", 2),
           ("kenngr.measure.input_edge_banding", "2", 2), ("kenngr.measure.input", "2", 2),
           ("antr.probing_input_nbr", "2", 2), ("antr.canopen.probing_input_number", "2", 2)), 1),
    Chain((("kenngr.measure.input_edge_banding", "2", 2), ("kenngr.measure.input", "2", 2)), 1),
    Chain((("kenngr.measure.edge", "NEG", "NEG"), ("kenngr.mess_neg_flanke", "1", "NEG")), "POS"),
    Chain((("getriebe[0].dynamik.a_emergency", "7", 7),
           ("getriebe[0].dynamik.a_max", "8", 8)), 1000),
    Chain((("kenngr.dist_ctrl[0].a_max", "7", 7), ("getriebe[0].dynamik.a_max", "8", 8)), 1000),
    Chain(((f"{SLOPE}.d_stufe_1", "7", 7), (f"{SLOPE}.a_stufe_1", "8", 8)), 1000),
    Chain(((f"{SLOPE}.d_stufe_2", "7", 7), (f"{SLOPE}.a_stufe_2", "8", 8)), 1000),
    Chain(((f"{SLOPE}.d_grenz_stufe_1", "7", 7), (f"{SLOPE}.a_grenz_stufe_1", "8", 8)), 1000),
    Chain(((f"{SLOPE}.d_grenz_stufe_2", "7", 7), (f"{SLOPE}.a_grenz_stufe_2", "8", 8)), 1000),
    Chain(((f"{SLOPE}.a_feedh", "7", 7), (f"{SLOPE}.a_grenz_stufe_1", "8", 8)), 1000),
    Chain(((f"{SLOPE}.a_feedh", "7", 7), (f"{SLOPE}.a_grenz_stufe_2", "8", 8)), 1000),
    Chain(((f"{SHAPE}.a_feedh", "7", 7), (f"{SHAPE}.a_grenz", "8", 8)), 1000),
    Chain(((f"{SHAPE}.tr_feedh", "7", 7), (f"{SHAPE}.tr_grenz", "8", 8)), 10_000),
    Chain((("getriebe[0].position_settling_time", "7", 7),
           ("getriebe[0].pos_einschw_zeit", "8", 8)), 1_000_000),
    Chain((("kin_step[1].trafo[2].type", "7", 7),
           ("kin_step[1].trafo[2].id", "9", 9)), 0, "channel"),
]  # fmt: skip
HERE = Origin("list.lst", 1)


def holding(chain: Chain, *links: tuple[str, str, Value]) -> ParameterSet:
    parameters = ParameterSet(chain.kind)
    for path, text, _ in links:
        parameters.load(path, text, HERE)
    return parameters


def head(chain: Chain) -> str:
    return chain.links[0][0]


@pytest.mark.parametrize("chain", CHAINS, ids=lambda chain: f"{head(chain)}-{len(chain.links)}")
def test_each_link_of_a_chain_decides_when_it_alone_is_set(chain: Chain) -> None:
    nothing = ParameterSet(chain.kind)
    assert nothing.get(head(chain)) == chain.end
    assert nothing.resolve(head(chain)).origin is None
    for link in chain.links:
        alone = holding(chain, link)
        assert alone.get(head(chain)) == link[2], link
        found = alone.resolve(head(chain))
        assert (found.key, found.origin) == (link[0], HERE)


@pytest.mark.parametrize("chain", CHAINS, ids=lambda chain: f"{head(chain)}-{len(chain.links)}")
def test_the_first_link_wins_over_the_later_ones(chain: Chain) -> None:
    for at, link in enumerate(chain.links):
        later = holding(chain, *chain.links[at:])
        assert later.get(head(chain)) == link[2], link


def test_every_parameter_with_a_fallback_stands_above() -> None:
    listed = {table(c.kind).find(head(c))[0].path for c in CHAINS}
    # the middle links, which the chains of their heads pass through
    listed |= {f"{DETECT}.pos_lag_limit", f"{DETECT}.min_time", "antr.probing_input_nbr"}
    rows = [row for kind in KINDS for row in table(kind).parameters if row.fallback]
    assert {row.path for row in rows} == listed


@pytest.mark.parametrize(
    "row",
    [row for kind in KINDS for row in table(kind).parameters if row.fallback],
    ids=lambda row: row.path,
)
def test_the_default_of_a_parameter_with_a_fallback_leaves_the_decision(row: Parameter) -> None:
    if row.path.endswith("start_distance"):  # 0 = at once; only a negative path falls back
        return
    assert row.is_unset(row.default)


def test_a_negative_start_distance_falls_back_and_ends_at_the_start_of_the_block() -> None:
    axis = ParameterSet("axis")
    axis.load(f"{STOP}.start_distance", "-5", HERE)
    assert axis.integer(f"{STOP}.start_distance") == 0
    axis.load(f"{DETECT}.start_distance", "300", HERE)
    assert axis.integer(f"{STOP}.start_distance") == 300


@pytest.mark.parametrize(("lag", "effective"), [("0", 0), ("-1", 9), ("-77", 9), ("5", 5)])
def test_lag_of_0_switches_the_criterion_off_and_negative_asks_the_older_one(
    lag: str, effective: int
) -> None:
    axis = ParameterSet("axis")
    axis.load("kenngr.fixed_stop_pos_lag_limit", "9", HERE)
    axis.load(f"{STOP}.pos_lag_limit", lag, HERE)
    assert axis.integer(f"{STOP}.pos_lag_limit") == effective


def test_a_chain_that_ends_in_cycles_is_a_time_once_the_cycle_is_known() -> None:
    axis = ParameterSet("axis")
    axis.load("kenngr.fixed_stop_nbr_cycles", "20", HERE)
    assert axis.ns(f"{STOP}.min_time", cycle_ns=2_000_000) == 40_000_000
    with pytest.raises(TypeError):
        axis.ns(f"{STOP}.min_time")
    axis.load(f"{DETECT}.min_time", "1500", HERE)
    assert axis.ns(f"{STOP}.min_time", cycle_ns=2_000_000) == 1_500_000


def test_a_set_default_still_counts_as_set() -> None:
    axis = ParameterSet("axis")
    assert not axis.is_set(f"{STOP}.start_distance")
    axis.load(f"{STOP}.start_distance", "0", HERE)
    assert axis.is_set(f"{STOP}.start_distance")


@pytest.mark.parametrize(
    ("path", "value", "message", "rotary"),
    [
        ("kenngr.probing_offset", 12345, "1.2345 mm", "1.2345 deg"),
        ("kenngr.dist_ctrl[0].max_act_value_change", 5000, "5 mm/s", "5 deg/s"),
        ("kenngr.vb_messen", 16666, "16.666 mm/s", "16.666 deg/s"),
        ("kenngr.dist_ctrl[0].a_max", 7, "7 mm/s2", "7 deg/s2"),
        ("kenngr.probe_actuation_time_delay", 1500, "1.5 ms", "1.5 ms"),
        ("kenngr.dist_ctrl[0].low_pass_filter_fg_f0", 25, "25 Hz", "25 Hz"),
        ("kenngr.dist_ctrl[0].i_tn", 5, "5 s", "5 s"),
        ("kenngr.dist_ctrl[0].v_weight_down", 505, "50.5 %", "50.5 %"),
        ("getriebe[0].kv", 1000, "10 1/s", "10 1/s"),
    ],
)
def test_a_unit_becomes_what_people_read(path: str, value: int, message: str, rotary: str) -> None:
    unit = UNITS[table("axis").find(path)[0].unit]
    assert unit.converted(value) == message
    assert unit.converted(value, is_rotary=True) == rotary


def test_every_unit_of_a_table_has_a_row_and_is_used() -> None:
    rows = [row for kind in KINDS for row in table(kind).parameters]
    assert {row.unit for row in rows} - {""} == set(UNITS)
    assert {name: unit.rotary for name, unit in UNITS.items() if unit.rotary != name} == {
        "0.1 um": "0.0001 deg",
        "um/s": "0.001 deg/s",
        "mm/s2": "deg/s2",
    }


@pytest.mark.parametrize("tenth_um", [1, 3, 7, 12345, 99_999_999, 2_147_483_647])
def test_lengths_convert_exactly_and_back(tenth_um: int) -> None:
    axis = ParameterSet("axis")
    axis.load("kenngr.probing_offset", str(tenth_um), HERE)
    assert axis.mm("kenngr.probing_offset") == tenth_um / 10_000
    assert round(axis.mm("kenngr.probing_offset") * 10_000) == tenth_um


def test_a_rotary_axis_knows_that_it_is_one() -> None:
    """By name or number; so does a spindle (P-AXIS-00018)."""
    axis = ParameterSet("axis")
    assert not axis.is_rotary
    for linear in ("ACHSTYP_TRANSLATOR", "1", "0x0001"):
        axis.load("kenngr.achs_typ", linear, HERE)
        assert not axis.is_rotary
    for rotary in ("ACHSTYP_ROTATOR", "2", "0x0002", "ACHSTYP_SPINDEL", "4", "0x0004"):
        axis.load("kenngr.achs_typ", rotary, HERE)
        assert axis.is_rotary


def test_an_older_setting_that_is_never_asked_is_named_unless_the_newer_one_is_set() -> None:
    older, newer = f"{DETECT}.start_distance", f"{STOP}.start_distance"
    axis = ParameterSet("axis")
    assert axis.unasked() == []
    axis.set(older, "100", HERE)
    assert axis.unasked() == [(older, newer)]
    axis.set(newer, "-1", HERE)  # it asks the older one
    assert axis.unasked() == []
    assert axis.integer(newer) == 100


def test_a_later_setting_acts_on_what_was_asked_before() -> None:
    """Resolved values are kept only until something is set, be it another link of the chain."""
    asked = f"{STOP}.pos_lag_limit"
    parameters = ParameterSet("axis")
    assert parameters.get(asked) == 0
    parameters.set("kenngr.fixed_stop_pos_lag_limit", "9", HERE)
    assert parameters.get(asked) == 9
    parameters.load(f"{DETECT}.pos_lag_limit", "8", HERE)
    assert parameters.get(asked) == 8
    parameters.correct(f"{DETECT}.pos_lag_limit", 6)
    assert parameters.get(asked) == 6
    parameters.set(asked, "7", HERE)
    assert parameters.get(asked) == 7


@pytest.mark.parametrize(("first", "second"), [(900, 400), (400, 900)])
def test_of_several_that_decide_the_smallest_counts(first: int, second: int) -> None:
    """P-AXIS-00024 unset: the smaller one of both limits of the linear slope, whichever it is."""
    axis = ParameterSet("axis")
    profile = "getriebe[0].lslope_profil"
    axis.set(f"{profile}.a_grenz_stufe_1", str(first), "test")
    axis.set(f"{profile}.a_grenz_stufe_2", str(second), "test")
    assert axis.integer(f"{profile}.a_feedh") == 400


def test_a_setting_replaces_what_was_corrected_with_its_warning() -> None:
    """A list has a value out of range, the plan a good one: nothing is left to be warned of."""
    axis = ParameterSet("axis")
    axis.load("kenngr.dist_ctrl[0].n_cycles", "100", Origin("list.lst", 1, 1))
    assert [item.alarm_id for item in axis.corrected()] == [315002]
    axis.set("kenngr.dist_ctrl[0].n_cycles", "20", "set:Z.kenngr.dist_ctrl[0].n_cycles")
    assert axis.corrected() == []
    assert axis.integer("kenngr.dist_ctrl[0].n_cycles") == 20


def test_a_copy_may_be_set_further_without_changing_what_it_was_made_of() -> None:
    """Rows share lists that are read once: values, warnings, IDs and places of one are its own."""
    read = ParameterSet("axis")
    read.load("kenngr.distc.kp", "1.0", Origin("list.lst", 1, 1))
    read.set("kenngr.messachse", "1", HERE)
    assert read.flag("kenngr.messachse")  # resolved before
    copy = read.copied()
    copy.set("kenngr.messachse", "0", "set:Z.kenngr.messachse")
    copy.load("kenngr.dist_ctrl[0].kp", "2.5", Origin("other.lst", 2, 1))
    assert (read.flag("kenngr.messachse"), copy.flag("kenngr.messachse")) == (True, False)
    # Neither was resolved before: what one has is not what the other has
    kp = "kenngr.dist_ctrl[0].kp"
    assert (read.get(kp), copy.get(kp)) == (1.0, 2.0)  # 2.5 is above the largest
    read.set("kenngr.messachse", "0", HERE)
    copy.set("kenngr.messachse", "1", HERE)
    assert (read.flag("kenngr.messachse"), copy.flag("kenngr.messachse")) == (False, True)
    assert (read.corrected(), len(copy.corrected())) == ([], 1)
    assert read.is_written_as("kenngr.distc.")
    assert not read.is_written_as("kenngr.dist_ctrl[0].")
    assert copy.is_written_as("kenngr.dist_ctrl[0].")
    origin = read.origin("kenngr.dist_ctrl[0].kp")
    assert origin is not None
    assert origin.short == "list.lst:1"


@pytest.mark.parametrize(
    ("path", "older", "word"),
    [
        ("kenngr.measure.signal", "kenngr.probing_signal_via_plc", "PLC"),
        ("kenngr.measure.edge", "kenngr.mess_neg_flanke", "NEG"),
    ],
)
def test_a_blank_word_leaves_the_decision_to_the_older_switch(
    path: str, older: str, word: str
) -> None:
    axis = ParameterSet("axis")
    axis.set(older, "1", "test")
    axis.load(path, "", Origin("list.lst", 1, 1))
    assert axis.is_set(path)
    assert axis.word(path) == word
