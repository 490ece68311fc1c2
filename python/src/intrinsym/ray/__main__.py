"""``python -m intrinsym.ray``: the command ``intrinsym-batch``."""

import sys

from ._command import main

if __name__ == "__main__":
    sys.exit(main())
