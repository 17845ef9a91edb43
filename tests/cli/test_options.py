"""What the commands share: numbers of processes, pairs of options, and how errors end them."""

import errno
from collections.abc import Callable

import pytest
import typer

from axisrig.bench.cli.options import JOBS_AUTO, _jobs, on_engine, rejecting
from axisrig.kernel.errors import UserError


def test_processes_are_a_number_from_one_on_or_auto() -> None:
    assert [_jobs(text) for text in ("auto", JOBS_AUTO, "1", 3, "16")] == [JOBS_AUTO] * 2 + [
        1,
        3,
        16,
    ]
    for text in ("0", "-1", "x", "", "1.5"):
        with pytest.raises(typer.BadParameter):
            _jobs(text)


def test_an_engine_needs_its_scheduler_and_the_other_way_round() -> None:
    assert on_engine(None, None) is None
    assert on_engine("dask", "tcp://host:8786") == "tcp://host:8786"
    for engine, scheduler in (("dask", None), (None, "tcp://host:8786")):
        with pytest.raises(UserError, match="go together"):
            on_engine(engine, scheduler)


def ended(error: BaseException) -> int:
    @rejecting
    def command() -> None:
        raise error

    with pytest.raises(typer.Exit) as caught:
        command()
    return caught.value.exit_code


def because(cause: BaseException) -> UserError:
    error = UserError("the results cannot be written")
    error.__cause__ = cause
    return error


def meanwhile(first: BaseException, error: BaseException) -> BaseException:
    """An error that came up while another one was treated."""
    error.__context__ = first
    return error


def endless() -> UserError:
    error = UserError("around")
    error.__context__ = other = ValueError()
    other.__context__ = error
    return error


@pytest.mark.parametrize(
    ("make", "code"),
    [
        (lambda: UserError("wrong"), 2),
        (lambda: OSError(errno.ENOENT, "not there", "a.csv"), 2),
        (lambda: OSError(errno.ENOSPC, "full", "a.csv"), 4),
        (lambda: OSError(errno.EFBIG, "too large", "a.csv"), 4),
        (lambda: because(OSError(errno.ENOSPC, "full")), 4),
        (lambda: because(OSError(errno.EACCES, "no")), 2),
        (lambda: because(because(OSError(errno.ENOSPC, "full"))), 4),
        (lambda: meanwhile(OSError(errno.ENOSPC, "full"), UserError("no report")), 4),
        (lambda: meanwhile(OSError(errno.ENOSPC, "full"), OSError(errno.EIO, "close")), 4),
        (lambda: because(meanwhile(OSError(errno.ENOSPC, "full"), ValueError("x"))), 4),
        (lambda: meanwhile(OSError(errno.EACCES, "no"), UserError("no report")), 2),
        (KeyboardInterrupt, 4),
        (endless, 2),
    ],
)
def test_an_error_ends_a_command_with_its_code(
    make: Callable[[], BaseException], code: int, capsys: pytest.CaptureFixture[str]
) -> None:
    assert ended(make()) == code
    assert capsys.readouterr().out == ""


def test_errors_are_lines_on_standard_error(capsys: pytest.CaptureFixture[str]) -> None:
    error = UserError("first", file="a.nc", line=3)
    error.excerpt = "N10 X\n    ^"
    error.further = [UserError(f"further {number}") for number in range(24)]
    ended(error)
    lines = capsys.readouterr().err.splitlines()
    assert lines[:4] == ["error: a.nc:3: first", "N10 X", "    ^", "error: further 0"]
    assert lines[-1] == "error: further 23"
    error.further = [UserError(f"further {number}") for number in range(27)]
    ended(error)
    lines = capsys.readouterr().err.splitlines()
    assert lines[-2:] == ["error: further 23", "error: 3 further errors"]
    ended(OSError(errno.ENOENT, "not there", "a.csv"))
    assert capsys.readouterr().err == "error: a.csv: not there\n"
    ended(OSError(errno.EIO, "broken"))
    assert capsys.readouterr().err == "error: command: broken\n"
    ended(KeyboardInterrupt())
    assert capsys.readouterr().err == "interrupted\n"
