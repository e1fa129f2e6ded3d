"""Make what a stranger installs: `python3 packaging/build.py`. On Linux a .deb and a .tar.zst, elsewhere their folder.

In `build/` an environment is made from `bundle.lock`, which holds the application with all its extras and what builds
it, and PyInstaller makes one folder from it, `installers/gaitwright.spec`. Licences and the bill of materials are put
beside it (`bundle_parts.py`), then it is packed into `dist/`. What Windows and macOS do with their folder is in
`installers/README.md`.
"""

import argparse
import hashlib
import os
import platform
import shutil
import subprocess
import sys
import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path

from linux_packages import make_archives, make_debs
from setup_environment import PYTHON_VERSION, ROOT, say

WORK = ROOT / "build"
LOCK = ROOT / "packaging" / "bundle.lock"
SPEC = ROOT / "packaging" / "installers" / "gaitwright.spec"
VERSION: str = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["version"]


def main(arguments: list[str]) -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--out", type=Path, default=ROOT / "dist", help="where to (dist)")
    parser.add_argument("--with-tour", action="store_true", help="also make what try_bundle.py leads a session with")
    parser.add_argument("--folder-only", action="store_true", help="pack nothing")
    required = parser.parse_args(arguments)
    python = make_environment(WORK / "environment")
    run([str(python), ROOT / "packaging" / "safety_tables.py"])  # ends here where a requirement has no test
    folder = freeze(python, is_with_tour=required.with_tour)
    (WORK / "version.txt").write_text(f"{VERSION}\n", encoding="ascii")  # for windows.iss
    required.out.mkdir(parents=True, exist_ok=True)
    bill = required.out / f"gaitwright-{VERSION}.cdx.json"
    run([str(python), ROOT / "packaging" / "bundle_parts.py", WORK / "work" / "gaitwright", folder, bill])
    shutil.copyfile(bill, folder / bill.name)
    say(f"{folder}: {megabytes(folder)} MB.")
    if required.folder_only:
        return
    if not sys.platform.startswith("linux"):
        say("Go on with packaging/installers/README.md.")
        return
    tour = folder / "gaitwright-tour"
    if tour.exists():
        tour.replace(required.out / tour.name)  # never part of what is given away
    for made in (*make_archives(folder, VERSION, required.out), *make_debs(folder, VERSION, required.out)):
        digest = hashlib.sha256(made.read_bytes()).hexdigest()
        (required.out / f"{made.name}.sha256").write_text(f"{digest}  {made.name}\n", encoding="ascii")
        say(f"{made}: {megabytes(made)} MB, SHA-256 {digest}")


def make_environment(place: Path) -> Path:
    """Make the environment that is frozen, unless it is there already, and give its Python."""
    python = place / ("Scripts/python.exe" if os.name == "nt" else "bin/python")
    stamp, made_from = place / "made-from", fingerprint()
    if stamp.is_file() and stamp.read_text(encoding="utf-8") == made_from and python.exists():
        return python
    say(f"Making {place}.")
    shutil.rmtree(place, ignore_errors=True)
    run([sys.executable, "-m", "venv", place])
    pip: list[str | Path] = [
        python,
        "-m",
        "pip",
        "--disable-pip-version-check",
        "install",
        "--quiet",
        "--no-deps",
        "--no-compile",
    ]
    run([*pip, "--only-binary", ":all:", "--require-hashes", "--requirement", LOCK])
    # in place: a copy would keep what was removed here since
    run([*pip, "--no-build-isolation", "--editable", ROOT])
    stamp.write_text(made_from, encoding="utf-8")
    return python


def fingerprint() -> str:
    made_from = hashlib.sha256(f"{PYTHON_VERSION}\n{ROOT}\n".encode())
    for file in (LOCK, ROOT / "pyproject.toml"):
        made_from.update(file.read_bytes())
    return made_from.hexdigest()


def freeze(python: Path, *, is_with_tour: bool) -> Path:
    """Let PyInstaller make the folder, always from nothing, and return it."""
    folder = WORK / "folder"
    shutil.rmtree(folder, ignore_errors=True)
    say("Freezing. This takes some minutes.")
    extra = {"GAITWRIGHT_TOUR": "1"} if is_with_tour else {}
    run(
        [
            *(python, "-m", "PyInstaller", "--noconfirm", "--clean", "--log-level", "ERROR"),
            *("--workpath", WORK / "work", "--distpath", folder, SPEC),
        ],
        # modules are compiled alike every time
        {"PYTHONHASHSEED": "1", "SOURCE_DATE_EPOCH": str(date_of_source()), **extra},
    )
    return folder / "gaitwright"


def date_of_source() -> int:
    """Seconds since 1970 of the last commit, so that two builds of it are alike; of the lock where there is no git."""
    try:
        answer = subprocess.run(
            ["git", "log", "-1", "--format=%ct"], cwd=ROOT, capture_output=True, text=True, check=True
        )
        return int(answer.stdout)
    except (OSError, subprocess.CalledProcessError, ValueError):
        return int(LOCK.stat().st_mtime)


def megabytes(place: Path) -> int:
    files = [place] if place.is_file() else [file for file in place.rglob("*") if not file.is_symlink()]
    return round(sum(file.stat().st_size for file in files if file.is_file()) / 1e6)


def run(command: Sequence[str | Path], environment: Mapping[str, str] | None = None) -> None:
    """Run a step to its end with its output shown; raises SystemExit where it fails."""
    if subprocess.call([str(word) for word in command], env={**os.environ, **(environment or {})}) != 0:
        sys.exit(f"{Path(command[0]).name} failed on {platform.platform()}. Nothing was packed.")


if __name__ == "__main__":
    main(sys.argv[1:])
