"""A master of somebody else and `axisrig drive --interface ecat`, at the ends of a veth pair.

Raw frames stay on a pair of virtual interfaces inside a network namespace that is made here.
"""

import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Sequence
from pathlib import Path

ROOT = Path(__file__).parents[2]
NAMESPACE = """
ip link set lo up && ip link add v0 type veth peer name v1 && ip link set v0 up &&
ip link set v1 up && sysctl -qw net.ipv6.conf.all.disable_ipv6=1; exec "$@"
"""


def in_namespace(*words: str) -> list[str]:
    """The command line of a command in a namespace of its own."""
    return ["unshare", "-n", "sh", "-c", NAMESPACE, "sh", *words]


def has_namespace() -> bool:
    """Whether a namespace with a veth pair can be made here."""
    if not sys.platform.startswith("linux") or not shutil.which("unshare"):
        return False
    tried = subprocess.run(in_namespace("true"), capture_output=True, check=False)
    return tried.returncode == 0 and not tried.stderr


def with_drives(
    rig: Path, out: Path, master: Sequence[str], timeout_s: float
) -> tuple[subprocess.CompletedProcess[str], str]:
    """Run a master at v0 while the drives of a rig are at v1; what it and they print."""
    drive = [sys.executable, "-m", "axisrig.bench.cli", "drive", str(rig), "--interface", "ecat"]
    drive += ["--channel", "v1", "-o", str(out)]
    process = subprocess.Popen(
        in_namespace(*drive), stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    )  # each step of it replaces itself by the next: this is the process of the drives
    assert process.stdout is not None
    lines = [process.stdout.readline()]
    while lines[-1] and "these slaves are the last ones" not in lines[-1]:
        lines.append(process.stdout.readline())
    assert any("slave 0 on v1" in line for line in lines), "".join(lines) + process.stdout.read()
    time.sleep(0.5)
    try:
        enter = ["nsenter", f"--net=/proc/{process.pid}/ns/net", *master]
        found = subprocess.run(
            enter, capture_output=True, text=True, timeout=timeout_s, check=False
        )
    finally:
        process.send_signal(signal.SIGINT)
        rest, _ = process.communicate(timeout=20)
    printed = "".join(lines) + rest
    assert found.returncode == 0, found.stdout + found.stderr + printed
    return found, printed
