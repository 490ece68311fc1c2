"""The command ``intrinsym-batch``, which says plainly what is missing where Ray is."""

from __future__ import annotations

import sys


def main() -> int:
    """Entry of the console script; the exit status."""
    try:
        from .ray._command import main as command
    except ImportError as error:
        print(f"intrinsym-batch: {error}", file=sys.stderr)
        return 2
    return command()


if __name__ == "__main__":
    sys.exit(main())
