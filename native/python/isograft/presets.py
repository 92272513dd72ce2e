# SPDX-License-Identifier: GPL-3.0-or-later
"""Named sets of options, and overrides of single options."""

from __future__ import annotations

import difflib
from collections.abc import Mapping
from typing import Any

import numpy as np

from isograft import _native
from isograft.arguments import to_float, to_int
from isograft.errors import InvalidInput

#: Every name that the command line and the add-on may offer, in order of effort; not every build has all.
_KNOWN = ("fast", "default", "thorough", "noisy", "paper")


def presets() -> list[str]:
    """Names of the presets of this build."""
    names = []
    for name in _KNOWN:
        try:
            _native.preset_options(name)
        except InvalidInput:
            continue
        names.append(name)
    return names


def preset_options(name: str = "default") -> dict[str, bool | int | float]:
    """Every option of a preset by its name `<stage>_<field>`: what match() takes as `overrides`.

    Raises InvalidInput for an unknown name.
    """
    if not isinstance(name, str):
        raise InvalidInput(f"preset must be a name, not {name!r}")
    options = _native.preset_options(name)
    options.pop("scale_value", None)  # match() has an argument of its own for it
    return options


def check_overrides(overrides: Mapping[str, Any], preset: str) -> dict[str, bool | int | float]:
    """The overrides with the types of the options they name. Raises InvalidInput for unknown names and wrong types."""
    options = preset_options(preset)
    checked: dict[str, bool | int | float] = {}
    for name, value in overrides.items():
        if name == "scale_value":
            raise InvalidInput("scale_value is not an option of its own: pass the number as scale")
        if name not in options:
            raise InvalidInput(f"there is no option {name!r}; {_nearest(name, list(options))}")
        default = options[name]
        if isinstance(default, bool):
            if not isinstance(value, (bool, np.bool_)):
                raise InvalidInput(f"{name} must be True or False, not {value!r}")
            checked[name] = bool(value)
        elif isinstance(default, int):
            checked[name] = to_int(value, name, -(2**31), 2**31 - 1)
        else:
            checked[name] = to_float(value, name)
    return checked


def _nearest(name: str, names: list[str]) -> str:
    close = difflib.get_close_matches(name, names, n=3, cutoff=0.6)
    if not close:
        # A field without its stage, or with another one: look at the field's part alone.
        close = [other for other in names if name.split("_", 1)[-1] in other or other.split("_", 1)[1] in name][:3]
    if close:
        return f"did you mean {', '.join(close)}?"
    return f"the options are {', '.join(names)}"
