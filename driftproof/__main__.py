"""`python -m driftproof` is the command line."""

import sys

from driftproof.cli import main

sys.exit(main())
