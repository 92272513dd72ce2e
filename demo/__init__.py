# SPDX-License-Identifier: GPL-3.0-or-later
"""The demonstration: a creature, a scan of it in another pose, and the graft of its texture."""
