"""`python -m app` is `gaitwright`; frozen into a program of its own, it is each process that this one starts, too.

Such a program is no Python that takes a module to run. It begins anew as itself, and what it is to be is told by its
arguments: a worker of a batch by those of `multiprocessing`, the reader of foreign files by a word.
"""

import sys


def begin() -> int:
    """Be what the arguments say, and give the exit code."""
    if getattr(sys, "frozen", False):
        become_child()
    from app.cli import main

    return main()


def become_child() -> None:
    """Do a child's work and end, if this process was started for it; else return at once."""
    from multiprocessing import freeze_support

    from devices.files import child

    freeze_support()
    if sys.argv[1:2] == [child.WORD]:
        child.main()
        sys.exit()


if __name__ == "__main__":
    sys.exit(begin())
