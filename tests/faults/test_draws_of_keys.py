"""Times, sizes and moments that a scenario draws, from random numbers that are written down."""

import csv
import random
from importlib import resources
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.tools.scenarios import scenario as scenarios
from axisrig.bench.tools.scenarios.scenario import (
    Kind,
    _fault,
    _moment,
    _place,
    _size,
    _time,
    drawn_kinds,
)


class Numbers(random.Random):
    """Gives `shares` in turn; of a choice the one at `place`, between two ends their middle."""

    def __init__(self, *shares: float, place: int = 0) -> None:
        super().__init__(0)
        self._shares, self._place = list(shares), place
        self.offered: list[list[Any]] = []

    def random(self) -> float:
        return self._shares.pop(0)

    def choice(self, seq: Any) -> Any:
        self.offered.append(list(seq))
        return seq[self._place]

    def choices(self, population: Any, weights: Any = None, **_: Any) -> Any:
        self.offered.append([*zip(population, weights, strict=True)])
        return [population[self._place]]

    def uniform(self, a: float, b: float) -> float:
        return (a + b) / 2


def test_each_decade_of_a_size_is_as_likely_in_both_directions() -> None:
    for share, size in ((0.0, 10), (0.5, 100), (1.0, 1000)):
        for place, sign in ((0, -1), (1, 1)):
            assert _size(10, 1000)(Numbers(share, place=place)) == str(sign * size)


def test_each_decade_of_a_time_is_as_likely_in_us_below_a_ms() -> None:
    draw = _time(10, 100_000)
    for share, text in ((0.0, "10us"), (0.25, "100us"), (0.49, "912us"), (0.5, "1.000ms"),
                        (0.6, "2.512ms"), (1.0, "100.000ms")):  # fmt: skip
        assert draw(Numbers(share)) == text


def test_a_moment_is_an_instant_or_an_event_at_once_or_later() -> None:
    """A fifth are instants; half of the others are at the event, half from 10 us to 50 ms later."""
    assert _moment(Numbers(0.19)) == "125.000ms"
    assert _moment(Numbers(0.2, 0.49, place=1)) == "motion"
    assert _moment(Numbers(0.9, 0.5, 0.0, place=-1)) == "seen+10us"
    assert _moment(Numbers(0.9, 0.5, 1.0)) == "start+50.000ms"


def test_each_column_of_the_table_of_kinds_is_in_its_own_field() -> None:
    folder = resources.files(scenarios.__package__ or "")
    text = folder.joinpath("kinds.csv").read_text(encoding="utf-8")
    rows = {row["kind"]: row for row in csv.DictReader(text.splitlines())}
    found = drawn_kinds.__wrapped__()
    assert list(found) == list(rows)
    for name, kind in found.items():
        row = rows[name]
        assert kind.name == name
        assert kind.weights == {"frames": int(row["frames"]), "every": int(row["every"])}
        lists = [" ".join(part) for part in (kind.targets, kind.keys, kind.hides, kind.jumps)]
        assert lists == [row[column] for column in ("targets", "keys", "hides", "jumps")]


@pytest.mark.parametrize(
    ("jumps", "target", "lets"),
    [
        (("RPDO", "SYNC"), "Z.RPDO2", True), (("RPDO", "SYNC"), "can1.SYNC", True),
        (("RPDO", "SYNC"), "Z.TPDO1", False), (("RPDO",), "RPDO1", True), (("every",), "Z", True),
        ((), "Z.RPDO1", False),
    ],
)  # fmt: skip
def test_with_which_telegrams_an_axis_may_jump(
    jumps: tuple[str, ...], target: str, lets: bool
) -> None:
    assert Kind("late", {}, (), (), (), jumps).lets_jump(target) is lets


def kind(*keys: str, targets: tuple[str, ...] = ("axis",)) -> Kind:
    return Kind("stop", {}, targets, keys, (), ())


def placed(monkeypatch: pytest.MonkeyPatch, *places: str) -> None:
    monkeypatch.setattr(scenarios, "places_of", lambda *_: places)
    rig = SimpleNamespace(axis={"X": 1, "Z": 2}, segment={"can1": 1, "can2": 2})
    monkeypatch.setattr(scenarios, "rig_of", lambda _: (rig, []))


@pytest.mark.interpreted
def test_a_place_is_of_the_drawn_target_or_telegram(monkeypatch: pytest.MonkeyPatch) -> None:
    """Telegrams by their weights, those alone that some place has; then one of their senders."""
    placed(monkeypatch, "X", "Z", "can1", "can2")
    both = kind(targets=("axis", "segment"))
    for place, target, offered in ((0, "X", ["X", "Z"]), (-1, "can2", ["can1", "can2"])):
        numbers = Numbers(place=place)
        assert _place(both, "m", numbers) == target
        assert numbers.offered == [["axis", "segment"], offered]
    numbers = Numbers(place=1)
    assert _place(kind(targets=("axis",)), "m", Numbers()) == "X"
    placed(monkeypatch, "X.SYNC", "X.TPDO1", "Z.TPDO1", "Z.TPDO3")
    assert _place(kind(targets=("telegram",)), "m", numbers) == "Z.TPDO3"
    assert numbers.offered == [[("TPDO1", 5), ("TPDO3", 1), ("SYNC", 3)]]
    numbers = Numbers()
    assert _place(kind(targets=("telegram",)), "m", numbers) == "X.TPDO1"
    assert numbers.offered[1:] == [["X.TPDO1", "Z.TPDO1"]]


@pytest.mark.interpreted
def test_a_key_is_drawn_as_often_as_its_share(monkeypatch: pytest.MonkeyPatch) -> None:
    """In the order of the kind; the program starts once."""
    placed(monkeypatch, "Z")
    drawn: dict[str, str] = {"at": "edge"}
    keys = {
        "at": (0.9, lambda _: drawn["at"]), "nth": (0.5, lambda _: 2), "value": (1.0, lambda _: 0)
    }  # fmt: skip
    monkeypatch.setattr(scenarios, "_KEYS", keys)
    form = kind("at", "nth", "value")
    assert _fault(form, "m", Numbers(0.89, 0.49, 0.99)) == "Z at=edge nth=2 value=0"
    assert _fault(form, "m", Numbers(0.9, 0.5, 0.99)) == "Z value=0"
    assert _fault(kind("value", "nth"), "m", Numbers(0.0, 0.0)) == "Z value=0 nth=2"
    drawn["at"] = "start+10us"
    assert _fault(form, "m", Numbers(0.0, 0.0, 0.0)) == "Z at=start+10us nth=1 value=0"
