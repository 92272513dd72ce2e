# SPDX-License-Identifier: GPL-3.0-or-later
"""The compiled module as other programs meet it: what it exports, what it needs, what importing it pulls in.

Newer Blenders load Eigen users and a TBB of their own. Our copies must neither be found by them nor be
replaced by theirs.
"""

import subprocess
import sys
from pathlib import Path

import isograft
from isograft import _native

MODULE = Path(_native.__file__)

SYSTEM_LIBRARIES = {
    "linux-vdso",
    "libc",
    "libm",
    "libpthread",
    "libdl",
    "librt",
    "libgcc_s",
    "libstdc++",
    "ld-linux-x86-64",
}


def output_of(*command: str) -> str:
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def exported() -> list[tuple[str, str]]:
    """Type letter and demangled name of every symbol the module defines for others."""
    lines = output_of("nm", "-D", "--defined-only", "--demangle", str(MODULE)).splitlines()
    return [(parts[1], parts[2]) for parts in (line.split(maxsplit=2) for line in lines)]


def test_the_module_exports_its_init_function_and_nothing_else() -> None:
    assert exported() == [("T", "PyInit__native")]


def test_the_module_needs_system_libraries_only() -> None:
    listed = output_of("ldd", str(MODULE)).splitlines()
    needed = {Path(line.split()[0]).name.split(".so")[0] for line in listed}
    assert "libc" in needed
    assert needed <= SYSTEM_LIBRARIES


def test_the_module_carries_no_path_of_the_machine_it_was_built_on() -> None:
    dynamic = output_of("readelf", "--dynamic", str(MODULE))
    assert "RPATH" not in dynamic
    assert "RUNPATH" not in dynamic


IMPORT_UNDER_A_BLOCKER = """
import sys

installed = {name for name in sys.argv[1].split(",")}

class Blocker:
    @staticmethod
    def find_spec(name, path=None, target=None):
        if name.partition(".")[0] in installed:
            raise ModuleNotFoundError(f"blocked: {name}", name=name)
        return None

sys.meta_path.insert(0, Blocker)
import isograft
import isograft.cli
isograft.presets()
print(sorted({name.partition(".")[0] for name in sys.modules} & (installed | {"numpy"})))
"""


def installed_top_level_names() -> set[str]:
    """Every importable name of the environment's packages, but for numpy and isograft."""
    site = Path(isograft.__file__).parent.parent
    folders = {Path(path) for path in sys.path if path.endswith("site-packages")} | {site}
    names = {
        entry.name.partition(".")[0]
        for folder in folders
        for entry in folder.iterdir()
        if entry.suffix in {".py", ".so"} or (entry.is_dir() and entry.name.isidentifier())
    }
    # The finder of an editable install is part of how isograft itself is found.
    return {name for name in names if name not in {"numpy", "isograft"} and not name.startswith("_")}


def test_importing_the_package_needs_numpy_only() -> None:
    blocked = installed_top_level_names()
    assert {"matplotlib", "distributed", "pytest", "hypothesis"} <= blocked
    run = subprocess.run(
        [sys.executable, "-c", IMPORT_UNDER_A_BLOCKER, ",".join(sorted(blocked))],
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == 0, run.stderr
    assert run.stdout.strip() == "['numpy']"
