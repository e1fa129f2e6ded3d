"""Check Gaitwright on a machine that has nothing but Python: `python3 packaging/test.py`.

Without arguments every check runs, and the tests but the long ones. With arguments only pytest runs, with them:
`test.py tests/core`, `test.py -m endurance`.
"""

import os
import subprocess
import sys

from setup_environment import ROOT, TESTED, SetUpError, hand_over, prepare, say

CHECKS = (
    ("ruff", "check"),
    ("ruff", "format", "--check"),
    ("mypy",),
    ("lint-imports",),
    ("pytest", "--numprocesses=2", "--dist=loadfile"),  # what a file prepares is prepared once
)


def main(arguments: list[str]) -> None:
    try:
        python = prepare(is_screen_needed=True, lock=TESTED)
    except SetUpError as missing:
        sys.exit(str(missing))
    os.chdir(ROOT)
    os.environ["QT_QPA_PLATFORM"] = "offscreen"
    # tests start Python hundreds of times: what is compiled once is kept, where it does not litter the project
    os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
    os.environ["PYTHONPYCACHEPREFIX"] = str(ROOT / ".venv" / "bytecode")
    if arguments:
        hand_over([str(python.with_name("pytest")), *arguments])
    failed = []
    for command, *options in CHECKS:
        name = " ".join((command, *options))
        say(f"\n== {name}")
        if subprocess.call([python.with_name(command), *options]) != 0:
            failed.append(name)
    subprocess.call([python, "-m", "tests.sizes"])  # for whoever reads on: nothing is refused for its length
    if failed:
        sys.exit(f"\nFailed: {', '.join(failed)}.")
    say("\nEvery check passed.")


if __name__ == "__main__":
    try:
        main(sys.argv[1:])
    except KeyboardInterrupt:
        sys.exit("Stopped.")
