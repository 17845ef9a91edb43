"""Why a law is suggested: its sentences from numbers that are written down."""

from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.tools.tune import advice as advising
from axisrig.bench.tools.tune.advice import advise
from axisrig.bench.tools.tune.loop import Law

PLAIN = Law(0.2)
FASTER = [Law(0.3, 0.0, 0.002), Law(0.4, 0.0, 0.004), Law(0.25, 0.0, 0.008)]


@pytest.mark.parametrize(("paying", "chosen"), [(FASTER, FASTER[1]), ([], PLAIN)])
@pytest.mark.parametrize("slope_kp", [None, 0.35])
def test_each_part_of_a_law_has_its_reason(
    paying: list[Law], chosen: Law, slope_kp: float | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The range of kp is that of a P controller; Tn is looked for with the law that was chosen.

    The limit 0.9 is 4.5 times kp 0.2; the noise is 0.6 with a D part and 0.24 without.
    """
    tried: list[Law] = []

    def with_integral(_: Any, law: Law) -> Law | None:
        tried.append(law)
        return None if slope_kp is None else Law(slope_kp, 0.25, law.tv_s)

    def quality(_: Any, law: Law) -> Any:
        return SimpleNamespace(law=law, rise_cycles=7 if law == PLAIN else 1)

    loop: Any = SimpleNamespace(
        stable_kp=lambda: (0.05, 0.9), noise_gain=lambda law: 0.6 if law.tv_s else 0.24
    )
    monkeypatch.setattr(advising, "_calmest", lambda _, tv_s: PLAIN if tv_s == 0.0 else None)
    monkeypatch.setattr(advising, "_with_derivative", lambda *_: iter(paying))
    monkeypatch.setattr(advising, "_with_integral", with_integral)
    monkeypatch.setattr(advising, "quality", quality)
    found: Any = advise(loop)
    assert (found.law, found.quality.law, tried) == (chosen, chosen, [chosen])
    assert found.limits == (0.05, 0.9)
    assert (found.slope_law is None) is (slope_kp is None)
    of_kp, of_tv, of_tn = found.reasons
    assert of_kp.startswith("kp 0.2 is the largest that passes a step by 2% at most")
    assert "4.5 times below the limit and reaches 90 % of a step in 7 cycles" in of_kp
    if paying:
        assert of_tv.startswith("d_tv 0.004 s lets kp grow from 0.2 to 0.4 at the same calmness;")
        assert of_tv.endswith("has 2.5 times the noise")
    else:
        assert of_tv.startswith("d_tv 0: no derivative time makes it faster")
    assert of_tn.startswith("i_tn 0: ")
    assert ("i_tn 0.25 s with kp 0.35 would take" in of_tn) is (slope_kp is not None)
