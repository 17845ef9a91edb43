"""`axisrig objects`: names, units and addresses as the manual's page 1147811083 prints them."""

from collections.abc import Callable

import pytest

from axisrig.kernel.distance.objects import channel_objects

Axisrig = Callable[..., tuple[int, str, str]]


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("DIST_CTRL_IFC::a_max_int", "REAL64  0.1 um/s2  read  0x<AID>3000"),
        ("DIST_CTRL_IFC::sloped_delta_deviation", "SGN64  0.01 nm  read  0x<AID>3001"),
        ("DIST_CTRL::m_actual_offset", "SGN64  0.01 nm  read  0x<AID>3100"),
        ("DIST_CTRL::v_max_int", "REAL64  0.1 um/s  read  0x<AID>3102"),
        ("DIST_CTRL::set_distance", "SGN64  0.01 nm  read  0x<AID>3103"),
        ("DIST_CTRL::set_pos", "SGN64  0.01 nm  read  0x<AID>3104"),
        ("DIST_CTRL::kp", "REAL64  read write"),
    ],
)
def test_every_object_has_type_unit_access_and_address(
    axisrig: Axisrig, name: str, words: str
) -> None:
    code, out, _ = axisrig("objects")
    assert code == 0
    assert f"{name}  {words}" in out.splitlines()
    assert "index group 0x120300" in out


def test_objects_of_a_channel_are_numbered_in_the_order_of_its_loop(axisrig: Axisrig) -> None:
    lines = axisrig("objects")[1].splitlines()
    begin = next(at for at, line in enumerate(lines) if line.startswith("3D distance control"))
    rows = [line.split("  ") for line in lines[begin + 1 :] if line[:1].isdigit()]
    assert [row[0] for row in rows] == [str(number) for number in range(1, len(rows) + 1)]
    assert [row[1] for row in rows] == [row.name for row in channel_objects().values()]
