# SPDX-License-Identifier: GPL-3.0-or-later
"""The package's exceptions; the compiled part raises the same classes."""

from isograft._native import Cancelled, InvalidInput, ResourceLimit

__all__ = ["Cancelled", "InvalidInput", "ResourceLimit"]
