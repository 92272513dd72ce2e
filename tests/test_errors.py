# SPDX-License-Identifier: GPL-3.0-or-later
"""What match() refuses, before it starts; and the classes of the errors."""

from __future__ import annotations

import pickle
from typing import Any

import isograft
import numpy as np
import pytest
import surfaces

BALL = surfaces.sphere(2)
SURFACE = isograft.Surface(*BALL)


def started(stage: str, fraction: float) -> bool:
    raise AssertionError("match() started although its arguments are wrong")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"preset": "best"}, 'no preset "best".*default'),
        ({"preset": None}, "preset must be a name"),
        ({"scale": "big"}, '"auto", "fixed" or a positive number'),
        ({"scale": 0}, "scale must be positive"),
        ({"scale": -2.0}, "scale must be positive"),
        ({"scale": float("nan")}, "scale must be finite"),
        ({"scale": [1]}, "scale must be a number"),
        ({"scale": True}, "scale must be a number"),
        ({"threads": 0}, "threads must be from 1"),
        ({"threads": 1.5}, "threads must be an integer"),
        ({"seed": -1}, "seed must be from 0"),
        ({"seed": 2**64}, "seed must be from 0"),
        ({"progress": 5}, "progress must be callable"),
        ({"growth_strech_limit": 0.4}, "no option 'growth_strech_limit'; did you mean growth_stretch_limit"),
        ({"stretch_limit": 0.4}, "did you mean .*growth_stretch_limit"),
        ({"landmark": []}, "no option 'landmark'"),
        ({"growth_stretch_limit": "wide"}, "growth_stretch_limit must be a number"),
        ({"growth_stretch_limit": None}, "growth_stretch_limit must be a number"),
        ({"growth_stretch_limit": float("inf")}, "growth_stretch_limit must be finite"),
        ({"growth_stretch_limit": -1.0}, "stretch_limit"),
        ({"hierarchy_samples": 500.5}, "hierarchy_samples must be an integer"),
        ({"hierarchy_samples": 2**40}, "hierarchy_samples must be from"),
        ({"hierarchy_samples": -5}, "samples"),
        ({"scale_value": 2.0}, "pass the number as scale"),
        ({"landmarks": [[0, 1], [2]]}, "landmarks is not an array"),
        ({"landmarks": [0, 1]}, r"landmarks must have shape \(k, 2\), not \(2,\)"),
        ({"landmarks": [[0.5, 1.0]]}, "landmarks must hold integers"),
        ({"landmarks": [[0, 1], [162, 2]]}, "landmark 1: source vertex 162 .* 162 vertices"),
        ({"landmarks": [[0, -1]]}, "landmark 0: target vertex -1"),
        ({"landmarks": [[0, 1], [0, 2]]}, r"landmarks \[0, 1\] name the same source vertex 0"),
        ({"landmarks": [[3, 1], [0, 1]]}, r"landmarks \[0, 1\] name the same target vertex 1"),
        ({"landmarks": {"source": [1, 2], "target": [3]}}, "2 of the source and 1 of the target"),
        ({"landmarks": {"source": [1, 2]}}, 'must have the keys "source" and "target"'),
        ({"landmarks": {"source": [[1]], "target": [3]}}, "must be a list of vertex indices"),
        ({"landmarks": {"source": 1, "target": 3}}, "must be a list of vertex indices"),
        ({"landmarks": "0 1"}, "landmarks must hold real numbers"),
    ],
)
def test_a_wrong_argument_is_refused_with_its_name_before_the_run(arguments: dict[str, Any], words: str) -> None:
    with pytest.raises(isograft.InvalidInput, match=words):
        isograft.match(SURFACE, SURFACE, **({"progress": started} | arguments))


@pytest.mark.parametrize(
    ("source", "words"),
    [
        (5, "source must be an isograft.Surface or a tuple"),
        (BALL[0], "source must be an isograft.Surface or a tuple"),
        ((BALL[0], BALL[1], None, None), "tuple of 4"),
        ((BALL[0], BALL[1] + 1), "source: .*162"),
        ((BALL[0][:, :2], BALL[1]), "source: vertices must have shape"),
    ],
)
def test_a_wrong_surface_is_refused_with_its_side(source: Any, words: str) -> None:
    with pytest.raises(isograft.InvalidInput, match=words):
        isograft.match(source, SURFACE)


@pytest.mark.parametrize("name", sorted(isograft.preset_options()))
def test_every_option_refuses_what_is_no_value_of_its_kind(name: str) -> None:
    for value in (float("nan"), "1", None, [], 10**400, True):
        if isinstance(isograft.preset_options()[name], bool) and value is True:
            continue
        with pytest.raises(isograft.InvalidInput, match=name):
            isograft.match(SURFACE, SURFACE, progress=started, **{name: value})


@pytest.mark.parametrize("name", sorted(isograft.preset_options()))
@pytest.mark.parametrize("value", [-(2**31), -1])
def test_every_option_refuses_negative_numbers_and_names_the_field(name: str, value: int) -> None:
    with pytest.raises(isograft.InvalidInput, match=name.split("_", 1)[1]):
        isograft.match(SURFACE, SURFACE, progress=started, **{name: value})


def test_presets_differ_and_all_have_the_same_options() -> None:
    assert {"fast", "default", "thorough"} <= set(isograft.presets())
    options = [isograft.preset_options(name) for name in isograft.presets()]
    assert all(list(other) == list(options[0]) for other in options)
    assert len({tuple(other.values()) for other in options}) == len(options)


def test_errors_belong_to_the_package_and_derive_from_the_usual_classes() -> None:
    assert issubclass(isograft.InvalidInput, ValueError)
    assert issubclass(isograft.ResourceLimit, MemoryError)
    assert issubclass(isograft.Cancelled, Exception)
    for error in (isograft.InvalidInput, isograft.ResourceLimit, isograft.Cancelled):
        assert error.__module__ == "isograft"
        again = pickle.loads(pickle.dumps(error("why")))
        assert type(again) is error
        assert again.args == ("why",)


def test_numpy_numbers_are_as_good_as_pythons() -> None:
    with pytest.raises(isograft.Cancelled):
        isograft.match(
            SURFACE, SURFACE, progress=lambda *_: False, threads=np.int64(1), seed=np.uint8(3), scale=np.float32(1),
            growth_stretch_limit=np.float32(0.5), hierarchy_samples=np.int16(700),
            landmarks=np.array([[0, 1]], np.uint16),
        )  # fmt: skip
