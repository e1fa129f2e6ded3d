"""`python -m app` is `gaitwright`."""

import sys

from app.cli import main

sys.exit(main())
