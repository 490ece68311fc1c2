# SPDX-License-Identifier: GPL-3.0-or-later
"""What strokes change in sculpt and paint modes, read and written after each stroke."""


def channel_of(object):
    return None


def key_of(object):
    return (object.mode,)
