"""Start Gaitwright on a machine that has nothing but Python: `python3 packaging/start.py`.

Without arguments the application opens; arguments are passed on as a subcommand (`start.py analyse SESSION --out OUT`).
Where there is no screen, the demonstration is computed instead.
"""

import os
import sys
from pathlib import Path

from setup_environment import SetUpError, prepare, run, say


def has_screen() -> bool:
    if not sys.platform.startswith("linux"):
        return True
    return bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))


def main(arguments: list[str]) -> int:
    is_demonstration = not arguments and not has_screen()
    try:
        python = prepare(is_screen_needed=not arguments and has_screen())
    except SetUpError as missing:
        say(str(missing))
        return 1
    # -P: a folder named `app` where the user stands is not ours
    application = [str(python), "-P", "-m", "app"]
    if not is_demonstration:
        return run([*application, *arguments])
    say("There is no screen here, so the demonstration is computed instead of opening the window.")
    code = run([*application, "demo"])
    if code == 0:
        say(f"The result is in {Path('gaitwright-demo').resolve()}.")
    return code


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
