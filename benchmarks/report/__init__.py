# SPDX-License-Identifier: GPL-3.0-or-later
"""What scripts/accuracy_report makes of a results.json: tables, curves, and pictures of the worst pairs.

results.json -> curves (matplotlib), worst pairs -> scenes (numpy) -> Blender -> page (docs/accuracy.md)
"""
