"""The command line, run by `python -m driftproof`."""

import sys

try:
    from driftproof.cli import main
except KeyboardInterrupt:
    print("driftproof: interrupted", file=sys.stderr)
    sys.exit(130)

sys.exit(main())
