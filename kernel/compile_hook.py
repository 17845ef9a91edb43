"""Compiles the rooms that a run spends its time in, when `AXISRIG_COMPILE=1` builds a wheel.

mypyc turns the modules into one C extension, `axisrig.kernel._compiled__mypyc`, and a small one for
each module, as black and mypy ship. The scheduler and the line of a bus are written in C as well,
each an extension of its own. The sources stay in the wheel; without the variable, and for an
editable installation, nothing is compiled and everything works the same, only slower.

With `AXISRIG_SHIP=1` as well the wheel is for others: the FMUs of all shipped models are inside,
with the keys of their sources, and zig links against glibc 2.28, so that it runs on every
manylinux_2_28. Both need the packages of `make wheel` in the environment that builds.

`pyproject.toml` names what is compiled.
"""

import json
import os
import sys
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

GROUP = "axisrig.kernel._compiled"
VARIABLE = "AXISRIG_COMPILE"
SHIP = "AXISRIG_SHIP"
GLIBC = "2.28"
LINKER = f"{sys.executable} -m ziglang cc -shared -target x86_64-linux-gnu.{GLIBC}"
TAG = "cp{0.major}{0.minor}-cp{0.major}{0.minor}-manylinux_{1}_x86_64"


def compiled_modules(root: Path, config: dict[str, Any]) -> list[str]:
    """Return the paths of the modules to compile, relative to `root`, in order.

    config: `compiled`, modules and folders (without those below them); `interpreted`, modules of
    these folders that are left out. Raises ValueError for an entry that does not exist.
    """
    found: list[str] = []
    for entry in config["compiled"]:
        path = root / entry
        files = [path] if path.is_file() else sorted(path.glob("[!_]*.py"))
        if not files:
            raise ValueError(f"pyproject.toml: compiled: {entry} is missing")
        found += [file.relative_to(root).as_posix() for file in files]
    unknown = sorted(set(config["interpreted"]) - set(found))
    if unknown:
        raise ValueError(f"pyproject.toml: interpreted: not in a compiled folder: {unknown}")
    return [path for path in found if path not in config["interpreted"]]


def native_extensions(config: dict[str, Any]) -> list[Any]:
    """Return the extensions written in C, to be built from the root of the project.

    config: `native`, their sources; each may include headers from the folders of all of them.
    """
    from setuptools import Extension  # noqa: PLC0415  only a compiled build needs it

    sources = [Path(source) for source in config["native"]]
    folders = sorted({source.parent.as_posix() for source in sources})
    extensions = []
    for source in sources:
        # Below the folder of a package's root: kernel/axisrig/kernel/time/_scheduler.c
        name = ".".join(source.with_suffix("").parts[1:])
        arguments = [] if os.name == "nt" else ["-std=c11", "-O2"]
        extensions.append(
            Extension(name, [source.as_posix()], include_dirs=folders, extra_compile_args=arguments)
        )
    return extensions


def shipped_fmus(root: Path) -> dict[str, str]:
    """Build the FMUs of the library by zig; return each file and its place in the wheel.

    With them goes `keys.json`: for each model its file, the key of its sources, and its hash.
    """
    from axisrig.fmus.build import MODELS, build, source_key  # noqa: PLC0415  needs rumoca
    from axisrig.fmus.shipped import KEYS, sha256_of  # noqa: PLC0415  as above

    folder = root / "out" / "shipped"
    rows = {}
    for model in MODELS:
        path = build(model, folder / f"{model.rpartition('.')[2]}.fmu", compiler="zig")
        rows[model] = {"file": path.name, "key": source_key(model), "sha256": sha256_of(path)}
    keys = folder / KEYS
    keys.write_text(json.dumps(rows, indent=1), encoding="utf-8")
    names = [row["file"] for row in rows.values()]
    return {str(folder / name): f"axisrig/fmus/shipped/{name}" for name in (*names, KEYS)}


class CompileHook(BuildHookInterface):  # type: ignore[type-arg]
    """Adds the extensions to a wheel and gives it the tag of this platform."""

    PLUGIN_NAME = "custom"

    @property
    def _is_on(self) -> bool:
        return self.target_name == "wheel" and os.environ.get(VARIABLE) == "1"

    def dependencies(self) -> list[str]:
        """What the build needs besides hatchling."""
        return ["mypy[mypyc]>=1.18,<3", "setuptools<81"] if self._is_on else []

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Compile, and put each extension beside the source of its module."""
        if version == "editable" or not self._is_on:
            return
        root = Path(self.root)
        build_data["pure_python"] = False
        build_data["infer_tag"] = True
        if os.environ.get(SHIP) == "1":
            build_data["infer_tag"] = False
            build_data["tag"] = TAG.format(sys.version_info, GLIBC.replace(".", "_"))
            os.environ["LDSHARED"] = LINKER
            build_data["force_include"] |= shipped_fmus(root)
        build_data["force_include"] |= self._build(compiled_modules(root, self.config), root)

    def _build(self, modules: list[str], root: Path) -> dict[str, str]:
        """Compile into `out/compiled`; return each extension and its place in the wheel.

        What is in that folder from an earlier list of modules is not returned.
        """
        from mypyc.build import mypycify  # noqa: PLC0415  only a compiled build needs it
        from setuptools import Distribution  # noqa: PLC0415  as above

        folder = root / "out" / "compiled"
        here = Path.cwd()
        os.chdir(root)
        try:
            extensions = mypycify(
                ["--config-file=pyproject.toml", *modules],
                opt_level="2",
                debug_level="0",
                group_name=GROUP,
                target_dir=str(folder / "c"),
            )
            for extension in extensions:
                if os.name != "nt":
                    # Part of Python's own -Wall; on generated code it takes twice the compilation
                    extension.extra_compile_args.append("-Wno-misleading-indentation")
            extensions += native_extensions(self.config)
            command = Distribution({"name": "axisrig", "ext_modules": extensions}).get_command_obj(
                "build_ext"
            )
            command.build_lib = str(folder / "lib")
            command.build_temp = str(folder / "objects")
            command.parallel = True  # an extension each on the processors
            command.ensure_finalized()
            command.run()
        finally:
            os.chdir(here)
        built = sorted(map(Path, command.get_outputs()))
        return {str(path): path.relative_to(folder / "lib").as_posix() for path in built}
