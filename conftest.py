"""The stages of the suite, for `pytest tests` and `pytest testplans/` alike: `tests/stages.py`."""

import pytest
from tests.stages import Stages


def pytest_addoption(parser: pytest.Parser) -> None:  # noqa: D103
    parser.addoption(
        "--stage", choices=("quick", "rest", "all"), help="of the suite; its CPU time is measured"
    )
    parser.addoption(
        "--until",
        type=float,
        metavar="UNIX_TIME",
        help="what has not begun by then, s since 1970, is skipped: CI has an hour on any machine",
    )
    parser.addoption(
        "--by-compiled",
        default="",
        metavar="FOLDERS",
        help="the compiled build runs these: a stage keeps what is marked `interpreted` of them",
    )


def pytest_configure(config: pytest.Config) -> None:  # noqa: D103
    config.addinivalue_line(
        "markers", "long(but=0): not in the quick stage, except for its first `but` rows"
    )
    config.pluginmanager.register(Stages(config), "axisrig stages")
