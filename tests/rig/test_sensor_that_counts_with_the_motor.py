"""Signs of sensors: which ones are warned of, of an axis alone and beside 3D control."""

from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.rig.distance import check

pytestmark = pytest.mark.interpreted  # stand-ins for typed parts


@pytest.mark.parametrize(
    ("signs", "has_3d", "warned"),
    [
        ((1,), False, ""), ((-1,), False, "-"), ((0,), False, "0"), ((1, -1), False, "-"),
        # 3D control wants the other sign: beside a sensor of the axis it is that of the channel
        ((1, -1), True, ""), ((-1, 1), True, ""), ((-1,), True, "-"), ((0, -1), True, "0-"),
        ((0, 1, -1), True, "0"), ((-1, -1), False, "--"),
    ],
)  # fmt: skip
def test_a_sensor_with_the_wrong_sign_is_warned_of(
    monkeypatch: pytest.MonkeyPatch, signs: tuple[int, ...], has_3d: bool, warned: str
) -> None:
    sensors = [SimpleNamespace(sign=sign, words=f"S{sign}") for sign in signs]
    monkeypatch.setattr(check, "sensors_of", lambda *_: sensors)
    monkeypatch.setattr(check, "is_released", lambda _: has_3d)
    monkeypatch.setattr(check, "_resolution", lambda *_: [])
    axis = SimpleNamespace(plant="z")
    settings: Any = SimpleNamespace(rig=SimpleNamespace(axis={"Z": axis}))
    found = ["0" if "is not wired to z" in text else "-" for text in check._wrong(settings, "Z")]
    assert "".join(found) == warned
