# SPDX-License-Identifier: GPL-3.0-or-later
"""One module per file format; isograft.files is the door."""
