"""``python -m cbtui`` is the ``cbtui`` command."""

import sys

from cbtui.cli import main

if __name__ == "__main__":
    sys.exit(main())
