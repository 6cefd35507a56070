"""``python -m stair_inspector``: the same as the command ``stair-inspector``."""

import sys

from stair_inspector.cli import main

if __name__ == "__main__":
    sys.exit(main())
