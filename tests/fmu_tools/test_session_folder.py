"""Folders in which FMUs are unpacked: they go with their process, also when that was killed."""

import os
import subprocess
import sys
import tempfile
from pathlib import Path
from types import SimpleNamespace

import pytest

from axisrig.bench.cli import pytest_plans
from axisrig.kernel.cosim.fmi import session

DAY_S = 86_400
HOLD = """\
import sys
from axisrig.kernel.cosim.fmi.session import session_folder
print(session_folder(), flush=True)
sys.stdin.read()
"""

pytestmark = pytest.mark.skipif(os.name != "posix", reason="locks of POSIX")


@pytest.fixture
def temporary(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder for temporary files, and a process that has none of its own yet."""
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    monkeypatch.setattr(session, "_SESSION", [])
    monkeypatch.setattr(session, "_OWN", {})
    return tmp_path


def _left(temporary: Path, name: str, *, days: float = 0.0, has_owner: bool = True) -> Path:
    folder = temporary / f"axisrig-fmu-{name}"
    (folder / "content").mkdir(parents=True)
    (folder / "content" / "large.so").write_bytes(b"x")
    if has_owner:
        (folder / "owner").touch()
    at_s = temporary.stat().st_mtime - days * DAY_S
    os.utime(folder, (at_s, at_s))
    return folder


def test_folders_of_dead_processes_go_and_all_others_stay(temporary: Path) -> None:
    dead = _left(temporary, "dead")
    older = _left(temporary, "older-release", days=8, has_owner=False)
    fresh = _left(temporary, "may-be-alive", days=1, has_owner=False)
    elsewhere = temporary / "elsewhere"
    _left(elsewhere, "linked")
    link = temporary / "axisrig-fmu-link"
    link.symlink_to(elsewhere / "axisrig-fmu-linked")
    other = _left(temporary, "x").rename(temporary / "other-tool")
    own = session.session_folder()
    assert own.parent == temporary
    assert not dead.exists()
    assert not older.exists()
    assert fresh.is_dir()
    assert (link / "content" / "large.so").is_file()
    assert other.is_dir()
    assert session.session_folder() == own


def test_a_folder_stays_as_long_as_a_process_of_it_lives(temporary: Path) -> None:
    """And goes when the next one comes after a kill."""
    with subprocess.Popen(
        [sys.executable, "-c", HOLD], env=os.environ | {"TMPDIR": str(temporary)},
        stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
    ) as process:  # fmt: skip
        assert process.stdout is not None
        folder = Path(process.stdout.readline().strip())
        session.session_folder()
        assert folder.is_dir()
        process.kill()
    assert folder.is_dir()
    session._SESSION.clear()
    session.session_folder()
    assert not folder.exists()


FORKS = """\
import os
import sys
from axisrig.kernel.cosim.fmi.session import session_folder
folder = session_folder()
child = os.fork()
if not child:
    sys.exit()
os.waitpid(child, 0)
print(folder, folder.is_dir())
"""


def test_a_forked_child_leaves_the_folder_to_the_process_that_made_it(tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-c", FORKS], env=os.environ | {"TMPDIR": str(tmp_path)},
        stdout=subprocess.PIPE, text=True, check=True,
    )  # fmt: skip
    folder, is_there = done.stdout.split()
    assert (is_there, Path(folder).exists()) == ("True", False)


def test_the_folder_of_this_process_can_go_before_its_end(temporary: Path) -> None:
    """Its own one alone, not that of another process that it shares; the next one is another."""
    shared = _left(temporary, "shared")
    session.share_session_folder(shared)
    session.remove_session_folder()
    assert shared.is_dir()
    session._SESSION.clear()
    own = session.session_folder()
    assert own.is_dir()
    session.remove_session_folder()
    assert not own.exists()
    session.remove_session_folder()


@pytest.mark.parametrize("is_worker", [True, False])
def test_a_worker_of_pytest_removes_it_at_the_end_of_its_session(
    temporary: Path, is_worker: bool
) -> None:
    """A worker of pytest-xdist is interrupted as it exits; other processes keep it until then."""
    own = session.session_folder()
    config = SimpleNamespace(workerinput={}) if is_worker else SimpleNamespace()
    pytest_plans.pytest_sessionfinish(SimpleNamespace(config=config))
    assert own.is_dir() is not is_worker
    session.remove_session_folder()
