# SPDX-License-Identifier: GPL-3.0-or-later
"""What all tests share: hypothesis without a deadline, since two cores may be busy with other lanes."""

from hypothesis import settings

settings.register_profile("isograft", deadline=None, derandomize=True, max_examples=50)
settings.load_profile("isograft")
