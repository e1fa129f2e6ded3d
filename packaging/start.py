"""Start Gaitwright on a machine that has nothing but Python: `python3 packaging/start.py`.

Without arguments the application opens; arguments are passed on as a subcommand (`start.py analyse SESSION --out OUT`).
Where there is no screen, the demonstration is computed instead.
"""

import os
import sys
from pathlib import Path

from setup_environment import SetUpError, copied_to_user, hand_over, prepare, say


def has_screen() -> bool:
    if not sys.platform.startswith("linux"):
        return True
    return bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))


def main(arguments: list[str]) -> None:
    is_window = not arguments and has_screen()
    try:
        if (copy := copied_to_user()) is not None:
            hand_over([sys.executable, str(copy / "packaging" / "start.py"), *arguments])
        python = prepare(is_screen_needed=is_window)
    except SetUpError as missing:
        sys.exit(str(missing))
    if not arguments and not is_window:
        say("There is no screen here, so the demonstration is computed instead of opening the window.")
        say(f"Its result goes to {Path('gaitwright-demo').resolve()}.")
        arguments = ["demo"]
    # -P: a folder named `app` in the user's current folder is not ours
    hand_over([str(python), "-P", "-m", "app", *arguments])


if __name__ == "__main__":
    main(sys.argv[1:])
