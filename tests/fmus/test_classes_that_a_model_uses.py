"""Classes that a model is made of, wherever its packages are: bases, parts, parts of parts."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.fmus.reading.texts import Texts

FILES = {
    "Own.mo": """
within;
package Own
  model Machine "the machine"
    extends Lib.Frames.Frame;
    Motor motor;
    parameter Real k = 1;
    Lib.Types.Way way;
  end Machine;
  model Motor
    extends Lib.Frames.Drive;
  end Motor;
end Own;
""",
    "Frames.mo": """
within Lib;
package Frames
  partial model Frame
    extends Common;
    inner Guide guide(width = 2);
    replaceable Inner.Rail rail;
  end Frame;
  partial model Common
    Guide again;
  end Common;
  model Guide
    Bolt bolt;
  end Guide;
  block Bolt
  end Bolt;
  partial model Drive
    input Real u;
    Own.Motor other;
    Winding winding;
  end Drive;
  model Winding
  end Winding;
  model Unused
  end Unused;
  package Inner
    model Rail
      Bolt bolt;
    end Rail;
  end Inner;
end Frames;
""",
    "Types.mo": 'within Lib;\npackage Types\n  type Way = Real(unit = "m");\nend Types;\n',
    "Lib.mo": "package Lib\nend Lib;\n",
}


@pytest.fixture
def texts() -> Texts:
    files = {at: (Path(name), text) for at, (name, text) in enumerate(FILES.items())}
    ir: Any = SimpleNamespace(files=files, model="Own.Machine")
    return Texts(ir)


def names_of(texts: Texts, model: str) -> list[str]:
    return [found.name for found in texts.used(model)]


def test_a_name_is_that_of_the_package_in_which_it_is_written(texts: Texts) -> None:
    """Guide, Common and Inner.Rail are of the package of the frame, Bolt of that of the guide."""
    found = names_of(texts, "Own.Machine")
    assert found[0] == "Own.Machine"
    assert len(found) == len({*found})
    assert {*found} == {
        "Own.Machine", "Own.Motor", "Lib.Frames.Frame", "Lib.Frames.Common", "Lib.Frames.Guide",
        "Lib.Frames.Inner.Rail", "Lib.Frames.Bolt", "Lib.Frames.Drive", "Lib.Frames.Winding",
    }  # fmt: skip


def test_what_is_nearer_to_the_model_comes_first(texts: Texts) -> None:
    found = names_of(texts, "Own.Machine")
    frames = "Lib.Frames."
    order = (
        (f"{frames}Frame", f"{frames}Guide"),
        ("Own.Motor", f"{frames}Drive"),
        (f"{frames}Guide", f"{frames}Bolt"),
        (f"{frames}Drive", f"{frames}Winding"),
    )
    for first, second in order:
        assert found.index(first) < found.index(second)


@pytest.mark.parametrize(
    ("model", "used"),
    [
        ("Own.Motor", ["Own.Motor", "Lib.Frames.Drive", "Lib.Frames.Winding"]),
        ("Lib.Frames.Inner.Rail", ["Lib.Frames.Inner.Rail", "Lib.Frames.Bolt"]),
        ("Lib.Frames.Bolt", ["Lib.Frames.Bolt"]),
        ("Lib.Frames.Gone", []),
        ("Own.Gone", []),
    ],
)
def test_a_model_uses_itself_and_no_other_way_round(
    texts: Texts, model: str, used: list[str]
) -> None:
    assert names_of(texts, model) == used


def test_bases_of_bases_are_found_in_their_own_package(texts: Texts) -> None:
    names = [found.name for found in texts.bases("Own.Machine")]
    assert names == ["Own.Machine", "Lib.Frames.Frame", "Lib.Frames.Common"]
    assert [found.name for found in texts.bases("Own.Motor")] == ["Own.Motor", "Lib.Frames.Drive"]
    assert texts.bases("Own.Gone") == []
