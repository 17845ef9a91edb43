"""Words about a tuned loop, from findings made by hand: warnings, dead time, reasons."""

from dataclasses import replace
from pathlib import Path as File
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from axisrig.bench.tools.tune.advice import Advice, Quality
from axisrig.bench.tools.tune.distance import (
    BOTH_ENCODERS,
    CONST_DIST,
    SET_POS,
    DeadTime,
    Mode,
    Tuning,
)
from axisrig.bench.tools.tune.identify import Path
from axisrig.bench.tools.tune.loop import Law, Loop
from axisrig.bench.tools.tune.report import data_of, text_of, warnings_of
from axisrig.kernel.distance.filters import FilterSettings

KP_0_2 = Law(0.2)
GOOD = Quality(0.0, 5, 3.0, 0.5, 1.5, 4.0)
ADVICE = Advice(Law(0.25, 0.0, 0.002), GOOD, (0.0, 1.0), None, ("reason one", "reason two"))


def mode(
    name: str, limit: float, *, is_stable: bool = True, advice: Advice | None = ADVICE
) -> Mode:
    loop = Loop(1e-3, np.array([0.0, 1.0]), np.array([1.0]))
    return Mode(name, loop, (0.0, limit), is_stable, None, advice)


def found(law: Law = KP_0_2, **given: Any) -> Tuning:
    """A tuned axis of which nothing is to be warned of."""
    values: dict[str, Any] = {
        "bench": SimpleNamespace(axis="Z", rig=File("rig.toml"), variable=None),
        "period_s": 1e-3,
        "configured": SimpleNamespace(
            law=law, filter=FilterSettings(kind="MOVING_AVERAGE", n_cycles=4), uses_both=False
        ),
        "rest_mm": 2.0,
        "step_mm": 0.05,
        "distance": Path(np.eye(1, 40, 3)[0], 1e-5, 1e-5),
        "actual": Path(np.eye(1, 40, 3)[0], 0.0, 0.0),
        "dead_time": DeadTime(1, 2, 1, 1_600_000),
        "modes": (mode(CONST_DIST, 1.0), mode(BOTH_ENCODERS, 1.0), mode(SET_POS, 2.0)),
    }
    return Tuning(**(values | given))


def test_a_good_list_has_no_warning() -> None:
    assert list(warnings_of(found())) == []


@pytest.mark.parametrize(
    ("law", "limit", "words"),
    [
        (Law(0.2), 0.3001, None),  # half as much again is enough
        (Law(0.2), 0.2999, "is stable, but only 1.50 times below the limit: it will ring."),
        (
            Law(0.2),
            0.25,
            "is stable, but only 1.25 times below the limit: it will ring. Set kp 0.25",
        ),
        (Law(1.5), 1.6, None),  # the limit is beyond what P-AXIS-00759 allows
    ],
)
def test_a_list_near_the_limit(law: Law, limit: float, words: str | None) -> None:
    modes = (mode(CONST_DIST, limit), mode(BOTH_ENCODERS, 9.0), mode(SET_POS, 9.0))
    said = list(warnings_of(found(law, modes=modes)))
    assert (len(said), words is None) in ((0, True), (1, False))
    assert words is None or words in said[0]


def test_unstable_modes_that_may_be_commanded_are_warned_of() -> None:
    """SET_POS may, and of CONST_DIST the one that the list chooses."""
    names = (CONST_DIST, BOTH_ENCODERS, SET_POS)
    modes = tuple(mode(name, 0.123, is_stable=False, advice=None) for name in names)
    said = list(warnings_of(found(Law(0.3, 0.0, 0.004), modes=modes)))
    assert [text.split(" with ")[0] for text in said] == [CONST_DIST, SET_POS]
    assert "kp 0.3, i_tn 0 s, d_tv 0.004 s and filter MOVING_AVERAGE, 4 values" in said[0]
    assert "unstable with 2 cycles of dead time: only kp below 0.123 is stable" in said[0]
    assert said[0].endswith("A shorter filter or less dead time would help.")
    of_both = found(modes=modes)
    of_both = replace(
        of_both, configured=SimpleNamespace(**{**vars(of_both.configured), "uses_both": True})
    )  # type: ignore[arg-type]
    said = [text.split(" with ")[0] for text in warnings_of(of_both)]
    assert said == [BOTH_ENCODERS, SET_POS]
    none = (mode(CONST_DIST, 0.0, is_stable=False), *modes[1:])
    assert "no kp is stable" in next(iter(warnings_of(found(modes=none))))


@pytest.mark.parametrize(
    ("distance", "step_mm", "words"),
    [
        (Path(1.019 * np.eye(1, 40, 3)[0], 0.0, 0.0), 0.05, None),
        (Path(1.021 * np.eye(1, 40, 3)[0], 0.0, 0.0), 0.05, "changes the distance by 1.021 mm"),
        (Path(0.97 * np.eye(1, 40, 3)[0], 0.0, 0.0), 0.05, "changes the distance by 0.970 mm"),
        (Path(np.eye(1, 40, 3)[0], 0.0, 0.00049), 0.05, None),
        (Path(np.eye(1, 40, 3)[0], 0.0, 0.00051), 0.05, "not linear by 0.51 um"),
        (Path(np.eye(1, 40, 3)[0], 0.0005, 0.00099), 0.05, None),  # twice the noise
        (Path(np.eye(1, 40, 3)[0], 0.0005, 0.00101), 0.05, "not linear by 1 um"),
        (Path(np.eye(1, 40, 3)[0], 0.001, 0.0), 0.05, None),
        (Path(np.eye(1, 40, 3)[0], 0.00101, 0.0), 0.05, "only 50 times the noise of the sensor"),
        (Path(np.eye(1, 40, 3)[0], 0.01, 0.0), 0.05, "only 5 times the noise of the sensor"),
    ],
)
def test_a_measurement_that_is_rough(distance: Path, step_mm: float, words: str | None) -> None:
    said = list(warnings_of(found(distance=distance, step_mm=step_mm)))
    assert len(said) == (words is not None)
    assert words is None or words in said[0]


@pytest.mark.parametrize(
    ("dead", "words"),
    [
        (DeadTime(1, 2, 1, 1_600_000),
         ["n = 2 cycles: an offset is sent 1 cycle later and is seen 2 cycles after that",
          "frames: 1.600 ms from set position to sensor value"]),
        (DeadTime(0, 1, 1, None),
         ["n = 0 cycles: an offset is sent in its own cycle and is seen 1 cycle after that"]),
        (DeadTime(2, 3, 4, None),
         ["n = 4 cycles: an offset is sent 2 cycles later and is seen 3 cycles after that at the"
          " latest", "the value is new every 4 cycles; the oldest counts"]),
    ],
)  # fmt: skip
def test_the_dead_time_in_words(dead: DeadTime, words: list[str]) -> None:
    assert dead.dead == dead.reaction + dead.way - 1
    lines = text_of(found(dead_time=dead)).splitlines()
    first = next(n for n, line in enumerate(lines) if line.startswith("dead time"))
    said = [line.removeprefix("dead time").strip() for line in lines[first : first + len(words)]]
    assert said == words
    assert lines[first + len(words)].startswith("filter        MOVING_AVERAGE, 4 values")


def test_the_text_of_a_mode() -> None:
    modes = (
        replace(mode(CONST_DIST, 1.0), closed_limit=0.98),
        mode(BOTH_ENCODERS, 0.0, advice=None),
        replace(mode(SET_POS, 2.0, is_stable=False), stable_kp=(0.5, 2.0)),
    )
    lines = text_of(found(modes=modes)).splitlines()
    assert "CONST_DIST (chosen by the list)" in lines
    assert "  stable for  kp < 1; closed form 0.98" in lines
    assert "  configured  kp 0.2, i_tn 0 s, d_tv 0 s: stable" in lines
    assert "  suggested   kp 0.25, i_tn 0 s, d_tv 0.002 s" in lines
    # v T/kp: 1 ms / 0.25 are 4 um for each mm/s
    assert sum("error on a slope 4 um for each mm/s of rise" in line for line in lines) == 1
    assert "  stable for  no kp" in lines
    assert "  suggested   nothing: no kp keeps this loop stable" in lines
    assert "  stable for  0.5 < kp < 2" in lines
    assert "  configured  kp 0.2, i_tn 0 s, d_tv 0 s: UNSTABLE" in lines
    assert sum("reason two" in line for line in lines) == 2
    with_i = text_of(found(Law(0.2, 0.1), modes=modes))
    assert "closed form" not in with_i  # it is that of a P controller


def test_the_data_have_what_the_text_has() -> None:
    data = data_of(found(Law(0.2, 0.1, 0.002)))
    assert (data["dead_cycles"], data["reaction_cycles"], data["way_cycles"]) == (2, 1, 2)
    assert (data["period_s"], data["step_mm"], data["noise_mm"]) == (1e-3, 0.05, 1e-5)
    assert data["answer"] == {
        "is_dead_time": True, "settled_cycles": 3, "mean_cycles": 3.0, "gain": 1.0
    }  # fmt: skip
    first, second, _ = data["modes"]
    assert (first["is_chosen"], second["is_chosen"]) == (True, False)
    assert first["configured"] == {"kp": 0.2, "i_tn_s": 0.1, "d_tv_s": 0.002}
    assert first["suggested"] == {"kp": 0.25, "i_tn_s": 0.0, "d_tv_s": 0.002}
    assert first["reasons"] == ["reason one", "reason two"]
