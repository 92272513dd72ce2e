# SPDX-License-Identifier: GPL-3.0-or-later
"""What scripts/benchmark runs: pairs of surfaces with known truth, each in a process of its own.

options -> cases (one pair, perhaps reversed or moved) -> children (one process each) -> tables
                                                          child: a method, then the measures
"""
