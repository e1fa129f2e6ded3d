"""Check Gaitwright on a machine that has nothing but Python: `python3 packaging/test.py`.

Without arguments every check runs, and the tests but the long ones. With arguments only pytest runs, with them:
`test.py tests/core`, `test.py -m endurance`.
"""

import os
import sys

from setup_environment import ROOT, SetUpError, prepare, run, say

CHECKS = (
    ("ruff", "check"),
    ("ruff", "format", "--check"),
    ("mypy",),
    ("lint-imports",),
    ("pytest",),
)


def main(arguments: list[str]) -> int:
    try:
        python = prepare(is_screen_needed=True)
    except SetUpError as missing:
        say(str(missing))
        return 1
    os.chdir(ROOT)
    os.environ["QT_QPA_PLATFORM"] = "offscreen"
    if arguments:
        return run([str(python.with_name("pytest")), *arguments])
    failed = []
    for command, *options in CHECKS:
        name = " ".join((command, *options))
        say(f"\n== {name}")
        if run([str(python.with_name(command)), *options]) != 0:
            failed.append(name)
    say(f"\nFailed: {', '.join(failed)}." if failed else "\nEvery check passed.")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
