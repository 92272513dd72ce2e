# SPDX-License-Identifier: GPL-3.0-or-later
"""Pack the add-on's folder and the wheels into one zip with the top folder isograft_addon.

Equal input gives equal bytes: entries are sorted and carry no time. A zip that is up to date is left alone.
"""

import argparse
import ast
import re
import stat
import sys
import zipfile
from pathlib import Path

ADD_ON = Path(__file__).resolve().parent / "isograft_addon"
EPOCH = (1980, 1, 1, 0, 0, 0)


def add_on_version() -> str:
    """The version in bl_info, which the manifest must repeat.

    Raises:
        SystemExit: the two differ.
    """
    tree = ast.parse((ADD_ON / "__init__.py").read_text())
    info = next(
        ast.literal_eval(node.value)
        for node in tree.body
        if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name) and node.targets[0].id == "bl_info"
    )
    version = ".".join(str(part) for part in info["version"])
    declared = re.search(r'^version = "(.*)"$', (ADD_ON / "blender_manifest.toml").read_text(), re.MULTILINE)
    if declared is None or declared[1] != version:
        sys.exit(f"package: bl_info has version {version}, blender_manifest.toml {declared and declared[1]}")
    return version


def contents(wheels: list[Path]) -> dict[str, bytes]:
    """What goes into the zip, by name inside the top folder."""
    files = {
        path.relative_to(ADD_ON).as_posix(): path.read_bytes()
        for path in ADD_ON.rglob("*")
        if path.is_file() and path.suffix in {".py", ".toml"}
    }
    names = "".join(f'  "./wheels/{wheel.name}",\n' for wheel in wheels)
    files["blender_manifest.toml"] += f"\nwheels = [\n{names}]\n".encode()
    files["LICENSE"] = (ADD_ON.parents[1] / "LICENSE").read_bytes()
    return files | {f"wheels/{wheel.name}": wheel.read_bytes() for wheel in wheels}


def write_zip(path: Path, files: dict[str, bytes]) -> None:
    """Write `files` below the top folder; the zip appears whole or not at all."""
    scratch = path.with_suffix(".part")
    with zipfile.ZipFile(scratch, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as archive:
        for name in sorted(files):
            entry = zipfile.ZipInfo(f"{ADD_ON.name}/{name}", EPOCH)
            entry.external_attr = (stat.S_IFREG | 0o644) << 16
            # A wheel is compressed already.
            entry.compress_type = zipfile.ZIP_STORED if name.endswith(".whl") else zipfile.ZIP_DEFLATED
            archive.writestr(entry, files[name])
    scratch.replace(path)


def is_current(path: Path, files: dict[str, bytes]) -> bool:
    """True if the zip at `path` holds just `files`."""
    if not path.exists():
        return False
    with zipfile.ZipFile(path) as archive:
        return {name: archive.read(name) for name in archive.namelist()} == {
            f"{ADD_ON.name}/{name}": content for name, content in files.items()
        }


def main() -> None:
    """Pack, unless the zip is up to date, and print its path."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--wheel", type=Path, action="append", required=True, help="one per supported Python")
    parser.add_argument("--output", type=Path, required=True, help="folder of the zip")
    arguments = parser.parse_args()
    version = add_on_version()
    for wheel in arguments.wheel:
        if wheel.name.split("-")[:2] != ["isograft", version]:
            sys.exit(f"package: the add-on has version {version}, the wheel is {wheel.name}")
    files = contents(arguments.wheel)
    arguments.output.mkdir(parents=True, exist_ok=True)
    path = arguments.output / f"{ADD_ON.name}-{version}.zip"
    if not is_current(path, files):
        write_zip(path, files)
    print(path)


if __name__ == "__main__":
    main()
