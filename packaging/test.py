"""Check Gaitwright on a machine that has nothing but Python: `python3 packaging/test.py`.

Without arguments every check runs, and the tests but the long ones. With arguments only pytest runs, with them:
`test.py tests/core`, `test.py -m endurance`. Tests that fail while others run beside them (`--numprocesses`) run once
more by themselves: no test may depend on what else the computer does.
"""

import json
import os
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

from setup_environment import ROOT, TESTED, SetUpError, hand_over, prepare, say

CHECKS = (
    ("ruff", "check"),
    ("ruff", "format", "--check"),
    ("mypy",),
    ("lint-imports",),
    ("pytest", "--numprocesses=2", "--dist=loadfile", "--durations=15"),  # what a file prepares is prepared once
)
CACHE = ROOT / ".pytest_cache"
MOST_AGAIN = 5  # more that fail are no matter of a busy computer
LAST_FAILED = "cache/lastfailed"  # by pytest, below its cache
CRASHED = "gaitwright/crashed"  # by tests/crashed.py, likewise: a test that ended its process


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
        pytest = [str(python.with_name("pytest")), *arguments]
        if not is_beside_others(arguments):
            hand_over(pytest)
        sys.exit(tested(pytest, CACHE))
    failed = []
    for command, *options in CHECKS:
        name = " ".join((command, *options))
        say(f"\n== {name}")
        call = [str(python.with_name(command)), *options]
        if (tested(call, CACHE) if is_beside_others(options) else subprocess.call(call)) != 0:
            failed.append(name)
    subprocess.call([python, "-m", "tests.sizes"])  # for whoever reads on: nothing is refused for its length
    if failed:
        sys.exit(f"\nFailed: {', '.join(failed)}.")
    say("\nEvery check passed.")


def tested(pytest: Sequence[str], cache: Path) -> int:
    """Run `pytest`, what failed once more without another test beside it, and return pytest's exit code."""
    for noted in (LAST_FAILED, CRASHED):
        (cache / "v" / noted).unlink(missing_ok=True)
    code = subprocess.call(pytest)
    failed = _last_failed(cache)
    if code != 1 or (cache / "v" / CRASHED).exists() or not 0 < len(failed) <= MOST_AGAIN:
        return code
    say("\n== once more, by themselves")
    code = subprocess.call([*pytest, "--numprocesses=0", "--last-failed", "--last-failed-no-failures=none"])
    for name in sorted(failed - _last_failed(cache)):
        say(f"Failed beside others and passed by itself: {name}")
    return code


def _last_failed(cache: Path) -> set[str]:
    try:
        return set(json.loads((cache / "v" / LAST_FAILED).read_text(encoding="utf-8")))
    except FileNotFoundError:  # nothing failed
        return set()


def is_beside_others(options: Sequence[str]) -> bool:
    return any(option.startswith("--numprocesses=") and option != "--numprocesses=0" for option in options)


if __name__ == "__main__":
    try:
        main(sys.argv[1:])
    except KeyboardInterrupt:
        sys.exit("Stopped.")
