"""What the page of `run --live` shows of a state, as its script draws it.

The script runs in node; cards, tables and lines are read as a reader would.
"""

import json
from pathlib import Path
from typing import Any

import pytest
from tests.live_states import AXIS, DISTANCE, LINE, REAL_TIME, SEGMENT, state
from tests.page_scripts import ELEMENTS, needs_node, value_in_node

from axisrig.bench.cli.beside import server

pytestmark = needs_node

SCRIPT = Path(server.__file__).with_name("page.js")
PAGE = f"""{ELEMENTS}
let source = null;
globalThis.EventSource = class {{
  constructor(address) {{
    Object.assign(this, {{address, acts: {{}}, is_open: true}});
    source = this;
  }}
  addEventListener(kind, act) {{ this.acts[kind] = act; }}
  close() {{ this.is_open = false; }}
}};
const at = (id) => document.getElementById(id);
const text = (id) => at(id).textContent;
const table = (id) => at(id).children.map((row) => row.children.map((one) => one.textContent));
const both = (one) => [one.className, one.textContent];
const lamps = (id) => at(id).querySelectorAll(".lamp").map(both);
const items = (id) => at(id).children.map(both);
const lines = (id) => at(id).querySelectorAll("polyline").map((one) => one.set.points ?? null);
const ranges = (id) =>
  at(id).querySelectorAll(".chart p").map((one) => one.children.at(-1).textContent);
function card(id, place = 0) {{
  const shown = at(id).children[place];
  return {{
    title: shown.children[0].children[0].textContent, big: shown.querySelector(".big").textContent,
    is_off: shown.classList.contains("off"),
    ...Object.fromEntries(shown.querySelector("dl").children.map(
      (row) => row.children.map((one) => one.textContent))),
  }};
}}
function after(looks, read) {{
  return looks.map(([kind, look]) => {{
    source.acts[kind](look && {{data: JSON.stringify(look)}});
    return read();
  }});
}}
"""
PROGRESS: dict[str, Any] = {
    "state": "2/9 runs, 1 pass; running: plan-a for 3 s",
    "verdicts": [
        {"verdict": "pass", "glyph": "✔", "runs": 12}, {"verdict": "fail", "glyph": "✘", "runs": 1},
    ],
    "ended": [
        {"run": "plan-x", "verdict": "pass", "glyph": "✔"},
        {"run": "plan-y", "verdict": "fail", "glyph": "✘"},
    ],
}  # fmt: skip


def look(shown: dict[str, Any] | None, age_s: float = 0.0, factor: float | None = 9.5) -> Any:
    return ["look", {"state": shown, "age_s": age_s, "factor": factor, "progress": PROGRESS}]


def read(what: str, *looks: Any) -> list[Any]:
    """What an expression gives after each of the looks."""
    return list(value_in_node(f"after({json.dumps(looks)}, () => {what})", [SCRIPT], PAGE))


def of(what: str, *changes: dict[str, Any]) -> list[Any]:
    """The same for states with changes."""
    return read(what, *(look(state(**each)) for each in changes))


def axis(**changes: Any) -> dict[str, Any]:
    return {"axes": [{**AXIS, **changes}]}


def distance(**changes: Any) -> dict[str, Any]:
    return {"distance": [{**DISTANCE, **changes}]}


def segment(**changes: Any) -> dict[str, Any]:
    return {"bus": [{**SEGMENT, **changes}]}


def test_an_axis_has_its_values_with_their_units() -> None:
    """Positions in mm, the lag in um."""
    (card,) = of('card("axes")', {})
    assert card == {
        "title": "Z", "big": "99.7503 mm", "is_off": False, "set": "99.5000 mm",
        "lag": "−250.3 µm", "touch probe": "armed", "input": "not actuated", "measuring": "moving",
        "last latch": "100.0001 mm, line 4, block N20, 1.250000 s",
    }  # fmt: skip


def test_of_an_axis_in_degrees_the_lag_is_in_thousandths_of_them() -> None:
    (card,) = of('card("axes")', axis(unit="°", lag=0.0125, actual=-12.5, latch=None))
    assert (card["big"], card["set"], card["lag"]) == ("−12.5000 °", "99.5000 °", "12.5 m°")
    assert card["last latch"] == "none"


def test_what_an_axis_does_not_have_is_a_dash_or_a_word() -> None:
    nothing = axis(set=None, lag=None, actual=None, measuring=None, latch=None, input=None)
    latch = {"position": -0.5, "block": "line 1", "time_ns": None}
    cards = of('card("axes")', nothing, axis(input=True, latch=latch))
    names = ("big", "set", "lag", "measuring", "last latch", "input")
    assert [cards[0][name] for name in names] == [
        "– mm", "– mm", "– µm", "no", "none", "not mapped (60FD)",
    ]  # fmt: skip
    assert (cards[1]["input"], cards[1]["last latch"]) == ("actuated", "−0.5000 mm, line 1, – s")


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.0, "0.0000 mm"), (-0.00004, "0.0000 mm"), (0.00004, "0.0000 mm"),
        (-0.00006, "−0.0001 mm"), (-1.0, "−1.0000 mm"), (1234.5, "1234.5000 mm"),
    ],
)  # fmt: skip
def test_nothing_has_no_sign(value: float, text: str) -> None:
    (card,) = of('card("axes")', axis(actual=value))
    assert card["big"] == text


def test_a_drive_has_a_lamp_for_what_its_state_means() -> None:
    """Good, bad and neither; a card with a bad one is marked until it is no longer bad."""
    words = {
        "operation enabled": "lamp on", "fault": "lamp bad", "switched on": "lamp ",
        "fault reaction active": "lamp bad", "quick stop active": "lamp bad",
        "ready to switch on": "lamp ", "error": "lamp bad",
    }  # fmt: skip
    found = of('[lamps("axes"), card("axes").is_off]', *(axis(drive=word) for word in words))
    expected = [[[[lamp, word]], lamp == "lamp bad"] for word, lamp in words.items()]
    assert found == expected


def test_a_real_drive_is_named_as_one() -> None:
    found = of('lamps("axes")', axis(is_outside=True), axis(is_outside=False))
    assert found == [
        [["lamp on", "operation enabled, real drive"]], [["lamp on", "operation enabled"]],
    ]  # fmt: skip


def test_each_axis_has_a_card_of_its_own() -> None:
    both = {"axes": [AXIS, {**AXIS, "axis": "C", "unit": "°", "set": 1.0, "drive": "fault"}]}
    ((first, second, lamps),) = of('[card("axes"), card("axes", 1), lamps("axes")]', both)
    assert [first["title"], first["set"], first["is_off"]] == ["Z", "99.5000 mm", False]
    assert [second["title"], second["set"], second["is_off"]] == ["C", "1.0000 °", True]
    assert lamps == [["lamp on", "operation enabled"], ["lamp bad", "fault"]]


def test_distance_control_has_its_values_and_the_sensor_has_the_reading() -> None:
    ((card, hidden),) = of('[card("distance"), at("distance-part").hidden]', distance())
    assert not hidden
    assert card == {
        "title": "Z", "big": "0.1250 mm offset", "is_off": False, "sensor": "SECOND_ENCODER",
        "reads": "−1.5000 mm", "distance": "1.5000 mm", "set value": "SET_DIST 1.2500 mm",
        "error": "−250.0 µm", "commanded by": "NC",
    }  # fmt: skip


def test_distance_control_has_a_lamp_and_says_what_holds_it() -> None:
    one = {"is_held": False, "is_dry_run": False}
    found = of(
        '[...lamps("distance")[0], card("distance").is_off]',
        distance(state="active", **one), distance(state="active const dist", **one),
        distance(state="freeze", is_held=True, is_dry_run=False), distance(state="error", **one),
        distance(state="inactive", is_held=True, is_dry_run=True),
    )  # fmt: skip
    assert found == [
        ["lamp on", "active", False], ["lamp on", "active const dist", False],
        ["lamp ", "freeze, held", False], ["lamp bad", "error", True],
        ["lamp ", "inactive, held, dry run", False],
    ]  # fmt: skip


def test_parts_are_there_while_there_is_something_in_them() -> None:
    parts = ("distance-part", "probe-part", "trouble", "message-part", "realtime", "main")
    read = f"{list(parts)}.map((id) => at(id).hidden)"
    full = {"alarms": ["a"], "messages": ["m"], "real_time": REAL_TIME, **distance()}
    empty: dict[str, Any] = {"probes": []}
    assert of(read, full, empty, full) == [[False] * 6, [True] * 5 + [False], [False] * 6]


def test_probes_are_on_or_off_with_their_edges() -> None:
    probes = [
        {"probe": "probe", "level": True, "edges": 1234, "edge_ns": 1_769_447_995},
        {"probe": "other", "level": False, "edges": 0, "edge_ns": None},
    ]
    ((rows, lamps),) = of('[table("probes"), lamps("probes")]', {"probes": probes})
    assert rows == [
        ["probe", "on", "1 234", "1.769448"], ["other", "off", "0", "–"],
    ]  # fmt: skip
    assert [name for name, _ in lamps] == ["lamp on", "lamp "]


def test_the_lamp_of_a_probe_follows_its_signal_whatever_edges_it_had() -> None:
    """Off after its first edge, on, off again; and one that is on from the beginning."""
    shown = [(False, 0), (True, 1), (False, 2), (True, 3), (True, 0)]
    signals = [
        {"probes": [{"probe": "probe", "level": level, "edges": edges, "edge_ns": 1_000}]}
        for level, edges in shown
    ]
    found = of('[lamps("probes"), table("probes")[0][2]]', *signals)
    assert found == [
        [[["lamp on", "on"] if level else ["lamp ", "off"]], str(edges)] for level, edges in shown
    ]


def test_of_two_probes_each_has_its_own_lamp_and_one_that_is_gone_has_none() -> None:
    def probe(name: str, level: bool, edges: int) -> dict[str, Any]:
        return {"probe": name, "level": level, "edges": edges, "edge_ns": None}

    found = of(
        'table("probes").map((row) => row.slice(0, 2)).concat(lamps("probes"))',
        {"probes": [probe("a", False, 4), probe("b", True, 0)]}, {"probes": [probe("b", False, 1)]},
    )  # fmt: skip
    assert found == [
        [["a", "off"], ["b", "on"], ["lamp ", "off"], ["lamp on", "on"]],
        [["b", "off"], ["lamp ", "off"]],
    ]


def test_a_bus_has_its_load_its_frames_and_who_counts_errors() -> None:
    counters = [
        {"node": "cnc", "tec": 136, "rec": 0, "state": "error passive"},
        {"node": "Z", "tec": 8, "rec": 1, "state": "error active"},
    ]
    found = of(
        'table("bus")[0]', segment(counters=counters),
        segment(counters=[], is_outside=True, lost="no answer"), segment(counters=[]),
    )  # fmt: skip
    assert found == [
        ["can1", "41.3 %", "12 345", "3",
         "cnc: error passive, TEC 136, REC 0; Z: error active, TEC 8, REC 1"],
        ["can1, real bus", "41.3 %", "12 345", "3", "lost: no answer"],
        ["can1", "41.3 %", "12 345", "3", "none"],
    ]  # fmt: skip


def test_a_line_has_its_cycle_its_counter_and_the_states_of_its_slaves() -> None:
    found = of('table("bus")[0].at(-1)', segment(counters=[], line=LINE))
    assert found[0].split("; ") == [
        "cycle 1000 µs, frame 10.08 µs", "working counter 6, wrong in 2 of 1 998", "X OP",
        "Z SAFEOP, 0x001B, x",
    ]  # fmt: skip


def test_a_bus_over_nine_tenths_is_full_and_its_bar_ends_at_100_percent() -> None:
    read = '[at("bus").querySelector(".load").className, at("bus").querySelector("rect").set.width]'
    found = of(read, *(segment(load_pct=load) for load in (0, 90, 90.1, 100, 130.5)))
    assert found == [
        ["load", "0%"], ["load", "90%"], ["load full", "90.1%"], ["load full", "100%"],
        ["load full", "100%"],
    ]  # fmt: skip


def test_a_campaign_has_its_counts_and_the_last_run_first() -> None:
    """The run under way is in the head of the page, and not in this line too."""
    read_ = '[text("campaign"), items("verdicts"), items("ended"), at("main").hidden]'
    at_main = "(at('main').hidden = true, 0)"
    assert read(f"{at_main} || {read_}", look(None)) == [[
        "2/9 runs, 1 pass", [["tile v-pass", "12✔ pass"], ["tile v-fail", "1✘ fail"]],
        [["", "✘ fail plan-y"], ["", "✔ pass plan-x"]], True,
    ]]  # fmt: skip


def test_the_head_has_the_run_its_row_and_its_time() -> None:
    ids = ["run", "title", "row", "channel", "time", "place", "block", "waits"]
    read = f"[document.title, ...{ids}.map(text)]"
    nothing = {"block": None, "block_text": None, "waits_for": "a start", "is_held": True}
    assert of(read, {}, {**nothing, "time_ns": 1_234_600_000}) == [
        ["plan-a · axisrig live", "plan-a", "one touch",
         "row plan.csv:2, rig rigs/r.toml, program programs/p.nc", "running", "2.000 s",
         "programs/p.nc line 4, block N20", "N20 G100 Z80 F600",
         "waits for the end of its move to Z 80 mm with 600 mm/min"],
        ["plan-a · axisrig live", "plan-a", "one touch",
         "row plan.csv:2, rig rigs/r.toml, program programs/p.nc", "running, feedhold", "1.235 s",
         "", "none", "a start"],
    ]  # fmt: skip


def test_a_large_factor_has_fewer_digits() -> None:
    factors = (None, 0.123, 9.994, 10, 123.45)
    found = read('text("factor")', *(look(state(), factor=factor) for factor in factors))
    assert found == ["–", "0.12", "9.99", "10.0", "123.5"]


def test_how_real_time_is_kept_is_a_sentence() -> None:
    sent = {**REAL_TIME, "send_errors": 3}
    words = ("real time: 7 of the last 500 SYNCs more than 100 us late, 812 us at most;"
             " plan moved by 1.5 ms in all")  # fmt: skip
    assert of('text("realtime")', {"real_time": REAL_TIME}, {"real_time": sent}) == [
        words, f"{words}; 3 frames not taken by the interface",
    ]  # fmt: skip


def test_alarms_and_messages_are_lists_that_follow_the_state() -> None:
    found = of(
        '[items("alarms"), items("messages")].map((list) => list.map((one) => one[1]))',
        {"alarms": ["A1", "<b>A2</b>"], "messages": ["m1"]}, {"alarms": ["A3"], "messages": []},
        {"alarms": [], "messages": ["m2", "m3"]},
    )  # fmt: skip
    assert found == [[["A1", "<b>A2</b>"], ["m1"]], [["A3"], []], [[], ["m2", "m3"]]]


def test_a_state_that_has_not_changed_for_long_is_old_until_the_next_one() -> None:
    """Longer than 1.5 s; before the first state nothing is."""
    read_ = '[document.body.classList.contains("is-old"), at("notice").hidden]'
    looks = [look(state(), age_s=age) for age in (0, 1.5, 1.51, 0.1)]
    assert read(read_, look(None, age_s=9), *looks) == [
        [False, True], [False, True], [False, True], [True, False], [False, True],
    ]  # fmt: skip


def test_a_lost_connection_is_shown_until_it_is_back_and_the_end_for_good() -> None:
    read_ = '[document.body.className, text("notice").split(" ").slice(0, 3).join(" "),' \
            ' source.is_open, text("time")]'  # fmt: skip
    last = ["end", look(state(time_ns=5_000_000_000), age_s=9)[1]]
    assert read(read_, look(state()), ["error", None], look(state()), ["error", None], last) == [
        ["", "", True, "2.000 s"], ["is-old", "No connection to", True, "2.000 s"],
        ["", "", True, "2.000 s"], ["is-old", "No connection to", True, "2.000 s"],
        ["has-ended", "The campaign has", False, "5.000 s"],
    ]  # fmt: skip
    assert read("source.address", look(None)) == ["/states"]


def at_times(*seconds: float, **changes: Any) -> list[dict[str, Any]]:
    """The same axis at several times."""
    return [{"time_ns": round(1e9 * one), **axis(**changes)} for one in seconds]


def test_a_line_is_drawn_from_the_first_state_to_the_last() -> None:
    """The width is 100; half of the height is 0.58 of what there is: 10 mm are 100 / 1.16 high."""
    states = [
        {"time_ns": 1_000_000_000, **axis(set=0, actual=0, lag=0)},
        {"time_ns": 2_000_000_000, **axis(set=10, actual=None, lag=0.002)},
        {"time_ns": 5_000_000_000, **axis(set=5, actual=5, lag=-0.002)},
    ]
    *_, (lines, ranges) = of('[lines("axes"), ranges("axes")]', *states)
    assert lines == [
        "0.00,93.10 25.00,6.90 100.00,50.00", "0.00,93.10 100.00,50.00",
        "0.00,50.00 25.00,6.90 100.00,93.10",
    ]  # fmt: skip
    assert ranges == ["0.0000 … 10.0000 mm", "−2.0 … 2.0 µm"]


def test_what_hardly_moves_is_a_straight_line_in_the_middle() -> None:
    """0.2 um of the 0.8 um that are shown at least."""
    states = [
        {"time_ns": 1_000_000_000, **axis(set=1, actual=1)},
        {"time_ns": 2_000_000_000, **axis(set=1.0002, actual=1)},
    ]
    first, second = of('lines("axes").slice(0, 2)', *states)
    assert first == ["0.00,50.00", "0.00,50.00"]
    assert second == ["0.00,62.50 100.00,37.50", "0.00,62.50 100.00,62.50"]


def test_nothing_is_drawn_of_what_is_not_known() -> None:
    (found,) = of('[lines("axes"), ranges("axes")]', axis(set=None, actual=None, lag=None))
    assert found == [[None, None, None], ["", ""]]


def test_each_time_is_a_point_once_and_an_earlier_one_begins_anew() -> None:
    count = 'lines("axes").map((one) => one.split(" ").length)'
    found = of(count, *at_times(1, 1, 1.5, 2, 2, 0.5, 0.6))
    assert [one[0] for one in found] == [1, 1, 2, 3, 3, 1, 2]
    assert all(len(set(one)) == 1 for one in found)


@pytest.mark.parametrize("earlier", [0.5, 1, 1.5, 2.999])
def test_a_time_before_the_last_one_begins_anew_wherever_it_is(earlier: float) -> None:
    """A run that begins later than the one before had begun, and earlier than that had come."""
    count = 'lines("axes").map((one) => one.split(" ").length)'
    found = of(count, *at_times(1, 2, 3, earlier, earlier + 0.1))
    assert [one[0] for one in found] == [1, 2, 3, 1, 2]


def test_another_run_or_other_axes_begin_anew_and_else_the_cards_stay() -> None:
    two = {"axes": [AXIS, {**AXIS, "axis": "C"}]}
    states = [*at_times(1, 2), {"time_ns": 3_000_000_000, "run": "plan-b"},
              {"time_ns": 4_000_000_000, "run": "plan-b"},
              {"time_ns": 5_000_000_000, "run": "plan-b", **two},
              {"time_ns": 6_000_000_000, "run": "plan-b", **two, **distance()},
              {"time_ns": 7_000_000_000, "run": "plan-b", **two, **distance()}]  # fmt: skip
    found = of('[at("axes").made, lines("axes")[0].split(" ").length]', *states)
    assert found == [[1, 1], [1, 2], [2, 1], [2, 2], [3, 1], [4, 1], [4, 2]]


def test_a_line_has_the_last_240_points() -> None:
    """Twelve seconds of 20 states each; the first of them moves out at the left."""
    points = 'lines("axes")[0].split(" ")'
    found = of(f"[{points}.length, {points}[1]]", *at_times(*range(242), actual=99.5))
    assert [found[one][0] for one in (238, 239, 240, 241)] == [239, 240, 240, 240]
    assert found[241][1] == "0.42,50.00"


def test_distance_control_has_lines_of_the_offset_and_of_the_sensor() -> None:
    states = [
        {"time_ns": 1_000_000_000, **distance(offset=0, reading=2)},
        {"time_ns": 2_000_000_000, **distance(offset=1, reading=1)},
    ]
    *_, (lines, ranges) = of('[lines("distance"), ranges("distance")]', *states)
    assert lines == ["0.00,93.10 100.00,6.90", "0.00,6.90 100.00,93.10"]
    assert ranges == ["0.0000 … 1.0000 mm", "1.0000 … 2.0000 mm"]
