"""`python -m app` is `gaitwright`; frozen into a program of its own, it is each process that this one starts, too.

Such a program is no Python that takes a module to run. It begins again as itself, and what it is to be is given by its
arguments: a worker of a batch by those of `multiprocessing`, the reader of foreign files and that of a camera by
a word.
"""

import os
import sys
from multiprocessing import freeze_support

LIBRARIES, LIBRARIES_BEFORE = "LD_LIBRARY_PATH", "LD_LIBRARY_PATH_ORIG"
BEGIN_AGAIN = "PYINSTALLER_RESET_ENVIRONMENT"


def begin() -> int:
    """Be what the arguments say, and give the exit code."""
    if getattr(sys, "frozen", False):
        begin_frozen()
    from app.cli.main import main  # a child is none of it

    return main()


def begin_frozen() -> None:
    """Do a child's work and end, if this process was started for it; else return at once."""
    _keep_own_libraries()
    from devices.own_children import CHILDREN  # for a frozen program only

    freeze_support()
    if len(sys.argv) > 1 and sys.argv[1] in CHILDREN:
        CHILDREN[sys.argv[1]].main()
        sys.exit()


def _keep_own_libraries() -> None:
    """Restore the system's library path for the programs this one starts; it has loaded its own by now."""
    before = os.environ.pop(LIBRARIES_BEFORE, None)
    os.environ.pop(LIBRARIES, None)
    if before:
        os.environ[LIBRARIES] = before
    os.environ[BEGIN_AGAIN] = "1"


if __name__ == "__main__":
    sys.exit(begin())
