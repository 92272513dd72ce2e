# SPDX-License-Identifier: GPL-3.0-or-later
"""The paper's experiments (section 5): what is matched, how, and the page about it."""
