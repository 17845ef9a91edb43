"""The list of runs of a report: what its script finds, filters, sorts and opens; its address.

The script runs in node with a page of four runs; plots and map are left out.
"""

import json
from pathlib import Path
from typing import Any

import pytest
from tests.page_scripts import ELEMENTS, needs_node, value_in_node

from axisrig import reports

pytestmark = needs_node

SCRIPT = Path(reports.__file__).with_name("page.js")
PAGE = f"""{ELEMENTS}
let address = null, mapped = null;
const listeners = {{}}, scrolled = [];  // scrolled: what was scrolled into view
globalThis.axisrigMap = {{
  make: () => ({{draw() {{}}, filter: (fits) => {{ mapped = bodies.map(idOf).filter(fits); }}}}),
}};
globalThis.axisrigPlots = {{unpack: (body) => new TextEncoder().encode(body)}};
globalThis.history = {{replaceState: (a, b, hash) => {{ address = hash; }}}};
globalThis.matchMedia = () => ({{addEventListener() {{}}}});
globalThis.addEventListener = (kind, act) => {{ listeners[kind] = act; }};
const idOf = (body) => body.dataset.run;
function made(tag, dataset, text = "") {{
  const one = new Shown(tag);
  Object.assign(one.dataset, dataset);
  if (text) one.textContent = text;
  return one;
}}
const ROWS = [  // id, verdict, cause, alarms, simulated s, card
  ["run-10", "pass", "", "2", 0.5, null], ["run-2", "fail", "late", "10", 12, "card-1"],
  ["run-1", "error", "an end", "", 3, "card-2"], ["run-3", "fail", "late", "1", 0.25, "card-1"],
];
const bodies = ROWS.map(([run, verdict, cause, alarms, sim, card], place) => {{
  const find = `${{run}} ${{verdict}} ${{cause}}`;
  const body = made("tbody", {{run, verdict, find, sim: String(sim)}});
  if (card) body.dataset.card = card;
  if (place === 1) body.dataset.example = "";
  const cells = [run, verdict, cause, alarms].map((text) => ({{textContent: ` ${{text}} `}}));
  body.rows = [{{cells}}];
  const opens = made("button", {{}});
  opens.className = "opens";
  body.append(opens);
  body.insertRow = () => {{
    const row = made("tr", {{}});
    row.insertCell = () => made("td", {{}});
    body.append(row);
    return row;
  }};
  body.scrollIntoView = () => scrolled.push(run);
  return body;
}});
const table = made("table", {{}});
table.tBodies = [...bodies];
table.append(...bodies);
const boxes = ["pass", "fail", "error"].map((value) =>
  Object.assign(made("input", {{}}), {{value, checked: true}}));
const heads = ["name", "verdict", "cause", "alarms", "sim"].map((sort) => {{
  const one = made("button", {{sort}});
  one.th = made("th", {{}});
  one.closest = () => one.th;
  return one;
}});
const cards = ["card-1", "card-2"].map((card) => {{
  const one = made("div", {{card}});
  one.className = "card";
  return one;
}});
const folded = made("details", {{}});
folded.append(cards[1]);
const lists = {{
  "script.stored": bodies.map((body) => made("script", {{run: idOf(body)}}, '{{"html":"h"}}\\n')),
  ".filter input": boxes, ".sort": heads, ".card": cards, ".folded": [folded], ".words > div": [],
}};
document.querySelectorAll = (path) => lists[path] ?? [];
document.querySelector = (path) => (path === ".verdicts" ? table : made("div", {{}}));
document.addEventListener = () => {{}};
for (const id of ["find", "found", "nothing", "print_all", "print", "summary"])
  places[id] = Object.assign(made("p", {{}}), {{
    value: "", scrollIntoView: () => scrolled.push(id),
  }});
places.map_data = made("script", {{}}, "{{}}");
document.getElementById = (id) => places[id] ?? null;
const order = () => table.children.map(idOf);
const shown = () => bodies.filter((body) => !body.hidden).map(idOf);
const opened = () => bodies.filter((body) => body.children.length > 1).map(idOf);
const sorted = () => heads.map((one) => one.th.set["aria-sort"] ?? null);
const find = (text) => {{ places.find.value = text; places.find.fire("input"); }};
const sort = (name) => heads.find((one) => one.dataset.sort === name).fire("click");
const box = (value, is) => {{
  const one = boxes.find((each) => each.value === value);
  one.checked = is;
  one.fire("change");
}};
function go(hash) {{ location.hash = hash; listeners.hashchange(); }}
"""


def read(what: str, hash_: str = "") -> Any:
    start = f"globalThis.location = {{hash: {json.dumps(hash_)}}};"
    return value_in_node(what, [SCRIPT], f"{PAGE}\n{start}")


def test_words_are_found_each_of_them_in_any_order_and_case() -> None:
    words = ["late", "LATE run-3", "end error", "late end", "  ", "run-1"]
    found = read(f"{words}.map((text) => (find(text), shown()))".replace("'", '"'))
    every = ["run-10", "run-2", "run-1", "run-3"]
    assert found == [["run-2", "run-3"], ["run-3"], ["run-1"], [], every, ["run-10", "run-1"]]


def test_a_card_is_found_by_its_whole_name() -> None:
    assert read('(find("card-1"), shown())') == ["run-2", "run-3"]
    assert read('(find("card-"), shown())') == ["run-2", "run-1", "run-3"]


def test_what_is_shown_is_counted_and_the_map_and_the_cards_follow() -> None:
    state = "[places.found.textContent, places.nothing.hidden, mapped," \
            " cards.map((one) => one.hidden), folded.hidden]"  # fmt: skip
    every = ["run-10", "run-2", "run-1", "run-3"]
    assert read(f'["", "late", "end", "nobody", ""].map((text) => (find(text), {state}))') == [
        ["", True, every, [False, False], False],
        ["2 of 4", True, ["run-2", "run-3"], [False, True], True],
        ["1 of 4", True, ["run-1"], [True, False], False],
        ["0 of 4", False, [], [True, True], True],
        ["", True, every, [False, False], False],
    ]  # fmt: skip


def test_a_box_that_is_not_ticked_hides_its_verdict_until_it_is() -> None:
    state = "[shown(), address]"
    assert read(f'[(box("fail", false), {state}), (box("pass", false), {state}),'
                ' (box("fail", true), box("pass", true), [shown().length, address])]') == [
        [["run-10", "run-1"], "#verdict=pass,error"], [["run-1"], "#verdict=error"], [4, "#"],
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("name", "up", "down"),
    [
        ("name", [1, 2, 3, 10], [10, 3, 2, 1]),
        ("verdict", [1, 2, 3, 10], [10, 2, 3, 1]),
        ("cause", [10, 1, 2, 3], [2, 3, 1, 10]),
        ("alarms", [1, 3, 10, 2], [2, 10, 3, 1]),
        ("sim", [3, 10, 1, 2], [2, 1, 10, 3]),
    ],
)  # fmt: skip
def test_a_head_sorts_up_then_down_then_not(name: str, up: list[int], down: list[int]) -> None:
    """Numbers by their value, the worst verdict first; equal ones stay as they were."""
    found = read(f'[1, 2, 3].map(() => (sort("{name}"), [order(), address,'
                 " sorted().filter(Boolean)]))")  # fmt: skip
    assert found == [
        [[f"run-{one}" for one in up], f"#sort={name}", ["ascending"]],
        [[f"run-{one}" for one in down], f"#sort={name}&down", ["descending"]],
        [["run-10", "run-2", "run-1", "run-3"], "#", []],
    ]


def test_another_head_begins_upwards() -> None:
    assert read('(sort("name"), sort("name"), sort("sim"), [order(), sorted()])') == [
        ["run-3", "run-10", "run-1", "run-2"], [None, None, None, None, "ascending"],
    ]  # fmt: skip


def test_an_address_shows_what_it_holds() -> None:
    hash_ = "#find=late&verdict=fail,error&sort=sim&down&open=run-3,nobody,run-2"
    state = (
        "[places.find.value, boxes.map((one) => one.checked), order(), shown(), opened(), scrolled]"
    )
    assert read(state, hash_) == [
        "late", [False, True, True], ["run-2", "run-1", "run-10", "run-3"], ["run-2", "run-3"],
        ["run-2", "run-3"], ["run-3"],
    ]  # fmt: skip
    assert read('(find("late x%&"), address)', hash_) == (
        "#find=late%20x%25%26&verdict=fail,error&sort=sim&down&open=run-2,run-3"
    )


def test_an_address_without_them_sets_all_back_but_a_place_of_the_page_does_not() -> None:
    state = "[places.find.value, shown().length]"
    assert read(f'[(go("#summary"), {state}), (go("#sort=nobody"), {state})]', "#find=late") == [
        ["late", 2], ["", 4],
    ]  # fmt: skip


def test_the_address_of_a_run_opens_it_also_where_it_is_filtered_away() -> None:
    state = "[opened(), shown().length, scrolled, address]"
    assert read(f'(go("#run-10"), {state})', "#find=late&verdict=fail") == [
        ["run-10"], 4, ["run-10"], "#open=run-10",
    ]  # fmt: skip
    assert read(f'(go("#run-2"), {state})', "#find=late")[1:] == [
        2, ["run-2"], "#find=late&open=run-2",
    ]  # fmt: skip


def test_what_is_printed_is_opened_for_it_and_closed_then() -> None:
    """The example of each card; with a tick all that are shown. What was open stays open."""
    steps = "[(listeners.beforeprint(), opened()), (listeners.afterprint(), opened())]"
    unprinted = 'bodies.filter((one) => one.classList.contains("unprinted")).map(idOf)'
    assert read(f"[{steps}, {unprinted}]", "#open=run-3") == [
        [["run-2", "run-3"], ["run-3"]], ["run-10", "run-1", "run-3"],
    ]  # fmt: skip
    assert read(f"(places.print_all.checked = true, {steps})", "#find=late") == [
        ["run-2", "run-3"], [],
    ]  # fmt: skip
