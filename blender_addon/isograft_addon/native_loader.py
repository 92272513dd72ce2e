# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes the package `isograft` importable from the wheels inside the add-on.

As an extension Blender has installed the wheel already. A legacy add-on has no such mechanism: the wheel for the
running Python is unpacked into a folder of the user's, keyed by version and content, never into the add-on itself.
"""

import hashlib
import importlib
import os
import re
import shutil
import sys
import tempfile
import tomllib
import zipfile
from pathlib import Path

import bpy

_WHEEL_NAME = re.compile(r"isograft-(?P<version>[^-]+)-(?P<python>[^-]+)-(?P<abi>[^-]+)-(?P<platform>[^-]+)\.whl")


class NativeUnavailableError(RuntimeError):
    """The native package cannot be loaded; the text says why and what to do."""


def load() -> None:
    """Make `import isograft` work, with the version this add-on was packed with.

    Raises:
        NativeUnavailableError: no wheel for this Python or system, or another version is loaded already.
    """
    if not is_extension():
        path = str(unpack(matching_wheel(Path(__file__).parent / "wheels"), user_folder()))
        if path not in sys.path:
            # In front, so that a package of the same name elsewhere cannot take its place.
            sys.path.insert(0, path)
        importlib.invalidate_caches()
    try:
        import isograft
    except ImportError as error:
        raise NativeUnavailableError(
            f"Isograft: the native package does not load ({error}); install the add-on again from its zip"
        ) from error
    if isograft.__version__ != add_on_version():
        raise NativeUnavailableError(
            f"Isograft: version {isograft.__version__} of the native package is loaded, this add-on needs "
            f"{add_on_version()}; restart Blender"
        )


def unload() -> None:
    """Take the unpacked folder off the import path. A loaded native module stays loaded until Blender ends."""
    if is_extension():
        return
    folder = user_folder()
    sys.path[:] = [path for path in sys.path if Path(path).parent != folder]


def is_extension() -> bool:
    """True if Blender installed this add-on as an extension."""
    return (__package__ or "").startswith("bl_ext.")


def add_on_version() -> str:
    """The add-on's version, from its manifest: of an extension Blender takes bl_info away."""
    with (Path(__file__).parent / "blender_manifest.toml").open("rb") as manifest:
        return str(tomllib.load(manifest)["version"])


def user_folder() -> Path:
    """Where a legacy add-on's wheels are unpacked."""
    return Path(bpy.utils.user_resource("DATAFILES", path="isograft"))


def matching_wheel(folder: Path) -> Path:
    """The wheel in `folder` for the running Python and system.

    Raises:
        NativeUnavailableError: there is none; the text lists the Pythons that there are wheels for.
    """
    python = f"cp{sys.version_info.major}{sys.version_info.minor}"
    found = [match for path in sorted(folder.glob("*.whl")) if (match := _WHEEL_NAME.fullmatch(path.name))]
    for match in found:
        if match["python"] == python and _runs_here(match["platform"]):
            return folder / match.string
    have = ", ".join(f"Python {m['python'][2]}.{m['python'][3:]} on {m['platform']}" for m in found) or "none"
    raise NativeUnavailableError(
        f"Isograft: this zip has no native package for Python {sys.version_info.major}.{sys.version_info.minor} on "
        f"{sys.platform}; it has: {have}. Take a Blender with one of these, or a zip that has yours"
    )


def unpack(wheel: Path, folder: Path) -> Path:
    """Unpack `wheel` below `folder`, once per version and content, and return where.

    The unpacked folder appears whole or not at all, also if two Blenders start at once.
    """
    digest = hashlib.sha256(wheel.read_bytes()).hexdigest()[:16]
    target = folder / f"{wheel.name.split('-')[1]}-{digest}"
    if target.is_dir():
        return target
    folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=folder, prefix="unpacking-") as scratch:
        whole = Path(scratch) / "wheel"
        with zipfile.ZipFile(wheel) as archive:
            archive.extractall(whole)
        try:
            whole.rename(target)
        except OSError:
            # Another Blender was faster: its folder has the same content.
            if not target.is_dir():
                raise
        finally:
            shutil.rmtree(whole, ignore_errors=True)
    return target


def _runs_here(platform_tag: str) -> bool:
    if sys.platform.startswith("linux"):
        return "linux" in platform_tag and os.uname().machine in platform_tag
    if sys.platform == "darwin":
        return platform_tag.startswith("macosx") and (
            os.uname().machine in platform_tag or "universal2" in platform_tag
        )
    return platform_tag == "win_amd64"
