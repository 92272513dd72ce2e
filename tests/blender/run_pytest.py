# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs pytest inside Blender, or inside a Python that has bpy; arguments follow after `--`."""

import sys

import pytest

sys.exit(pytest.main(sys.argv[sys.argv.index("--") + 1 :]))
