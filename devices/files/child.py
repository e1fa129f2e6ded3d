"""What runs in the limited process: one foreign file, or the files of one trial, at a time.

It is limited before it imports what reads them, is given its task in JSON, and answers as `answers` describes. On Linux
it reads nothing itself: each task has a copy of the process (a fork), the only one in which bytes of others are parsed,
and as little trusted as they are. It may open the task's own files and no others, and is gone with its answer.
"""

import os
import signal
import sys

from devices.files.limits import limit_this_process

TOML, SITE, TRIAL, GATHER, REFERENCE = "toml", "site", "trial", "gather", "reference"
QUESTION, PREVIEW, IMPORTER, VIDEO = "question", "preview", "importer", "video"
WORD = "read-foreign-files"  # the argument of a frozen program that is started as this process
READ, REFUSED, MEMORY, UNFORESEEN = "read", "refused", "memory", "unforeseen"


def main() -> None:
    """Read what is asked for on the standard input until nobody asks any more; the last argument: memory in bytes."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl C reaches all of a terminal; who asks ends this process
    asking, answering = os.fdopen(os.dup(0), "rb"), os.fdopen(os.dup(1), "wb")
    nowhere = os.open(os.devnull, os.O_RDWR)
    for stream in (0, 1, 2):  # what a library prints before it aborts is no line for the user
        os.dup2(nowhere, stream)
    limit_this_process(int(sys.argv[-1]))
    from devices.files.child_tasks import serve  # limited, before it imports what reads

    serve(asking, answering)


if __name__ == "__main__":
    main()
