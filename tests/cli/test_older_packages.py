"""Leftovers of an older axisrig: `axisrig doctor` and pytest name ours, and no others."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from axisrig.bench.campaign.older_packages import SIGNS, leftovers

ROOT = Path(__file__).parents[2]


def _file(path: Path, text: str = "") -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")


@pytest.mark.parametrize("name", SIGNS)
def test_a_folder_of_ours_is_named_with_its_new_name_and_a_remedy(
    tmp_path: Path, name: str
) -> None:
    _file(tmp_path / name / SIGNS[name])
    (text,) = leftovers([str(tmp_path), str(tmp_path), str(tmp_path / "absent")])
    assert text.startswith(f"{tmp_path}: {name} of an older axisrig (now axisrig.{name}): remove")
    assert "PYTHONPATH" in text


def test_an_installed_one_is_uninstalled(tmp_path: Path) -> None:
    for name in ("kernel", "bench", "reports"):
        _file(tmp_path / name / "__init__.py")
    info = tmp_path / "axisrig-0.0.9.dist-info"
    _file(info / "METADATA", "Metadata-Version: 2.1\nName: axisrig\nVersion: 0.0.9\n")
    _file(info / "RECORD", "kernel/__init__.py,,\nbench/__init__.py,,\nfmus/__init__.py,,\n")
    (text,) = leftovers([str(tmp_path)])
    assert f"{tmp_path}: kernel, bench of an older axisrig" in text  # fmus is not there
    assert "pip uninstall axisrig" in text


@pytest.mark.parametrize("newer", ["reports", "", "bench,kernel"])
def test_all_that_is_installed_in_a_folder_counts(tmp_path: Path, newer: str) -> None:
    """An uninstalled version may leave its record beside that of the one installed later."""
    for name in ("kernel", "bench", "reports"):
        _file(tmp_path / name / "__init__.py")
    for version, names in (("0.0.8", "kernel"), ("0.0.9", newer)):
        info = tmp_path / f"axisrig-{version}.dist-info"
        _file(info / "METADATA", f"Metadata-Version: 2.1\nName: axisrig\nVersion: {version}\n")
        listed = [f"{name}/__init__.py,,\n" for name in names.split(",") if name]
        _file(info / "RECORD", "".join(listed))
    (text,) = leftovers([str(tmp_path)])
    wanted = [name for name in SIGNS if name in {"kernel", *newer.split(",")}]
    now = ", ".join(f"axisrig.{name}" for name in wanted)
    assert text.startswith(f"{tmp_path}: {', '.join(wanted)} of an older axisrig (now {now}): run")


def test_packages_of_others_are_no_leftovers(tmp_path: Path) -> None:
    for file in ("bench/__init__.py", "bench/cli.py", "bench/app.py", "kernel/__init__.py"):
        _file(tmp_path / file)
    info = tmp_path / "frappe_bench-5.0.dist-info"
    _file(info / "METADATA", "Metadata-Version: 2.1\nName: frappe-bench\nVersion: 5.0\n")
    _file(info / "RECORD", "bench/__init__.py,,\nbench/cli.py,,\nbench/app.py,,\n")
    _file(tmp_path / "axisrig-0.1.0.dist-info/METADATA", "Name: axisrig\nVersion: 0.1.0\n")
    _file(tmp_path / "axisrig-0.1.0.dist-info/RECORD", "axisrig/bench/__init__.py,,\n")
    assert leftovers([str(tmp_path)]) == []


def test_this_checkout_has_none() -> None:
    folders = [ROOT, *(ROOT / name for name in SIGNS)]
    assert leftovers([str(folder) for folder in folders]) == []


@pytest.mark.long
def test_doctor_and_pytest_name_them(tmp_path: Path) -> None:
    _file(tmp_path / "old/bench/rig/machine.py")
    plans = tmp_path / "plans"
    _file(plans / "conftest.py", (ROOT / "testplans/conftest.py").read_text(encoding="utf-8"))
    env = os.environ | {"PYTHONPATH": str(tmp_path / "old")}
    for command, code in (
        (["axisrig.bench.cli", "doctor"], 0),
        (["pytest", "-q", "-p", "no:cacheprovider", "-c", os.devnull, str(plans)], 5),
    ):
        ended = subprocess.run(
            [sys.executable, "-m", *command], cwd=tmp_path, env=env,
            capture_output=True, text=True, check=False,
        )  # fmt: skip
        assert ended.returncode == code, ended.stdout + ended.stderr
        assert "old: bench of an older axisrig (now axisrig.bench): remove" in ended.stdout
