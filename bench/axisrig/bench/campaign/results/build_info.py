"""What is running: the sources as they are, or modules that a compiler made of them; and which.

A build of mypyc has the same sources beside its modules, so both have one hash.
"""

import hashlib
from functools import cache
from importlib.util import find_spec
from pathlib import Path

from axisrig.kernel.time import clock

_MADE = frozenset({".pyc", ".so", ".pyd"})
# FMUs that only a wheel has
_SHIPPED = "fmus/shipped/"
# The documents, which a wheel holds and a checkout has beside its packages
_DOCUMENTS = "reports/documents/"


def is_compiled() -> bool:
    """Return whether the kernel runs as compiled extension modules."""
    return Path(clock.__file__).suffix != ".py"


def build_word() -> str:
    """Return `compiled` or `interpreted`."""
    return "compiled" if is_compiled() else "interpreted"


@cache
def sources_sha256() -> str:
    """Return the SHA-256 of the sources and tables of axisrig, hex; equal for both builds.

    Names and bytes of every file of its packages count; what a compiler made of them does not.
    """
    spec = find_spec("axisrig")
    roots = [] if spec is None else [Path(root) for root in spec.submodule_search_locations or ()]
    return hash_of_sources(roots)


def hash_of_sources(roots: list[Path]) -> str:
    """Return the SHA-256 of the files in the folders of the package axisrig, hex."""
    files: dict[str, Path] = {}
    for root in roots:
        for path in root.rglob("*"):
            if path.suffix not in _MADE and path.is_file():
                name = path.relative_to(root).as_posix()
                if not name.startswith((_SHIPPED, _DOCUMENTS)):
                    files[f"axisrig/{name}"] = path
    whole = hashlib.sha256()
    for name, path in sorted(files.items()):
        whole.update(f"{name}\n{hashlib.sha256(path.read_bytes()).hexdigest()}\n".encode())
    return whole.hexdigest()
