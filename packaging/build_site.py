"""Build the site of the manual and the reference, English and German: `python3 packaging/build_site.py [OUT]`.

Its pages are those of `resources/help`, those of `packaging/site/pages`, the scripts of `tests/examples` with what they
print, the figures of `packaging/site/figures`, and what the code has to say of itself: public names, every command, the
meaning of every column. What turns them into a site, mkdocs-material, has an environment of its own in `build`, made of
`packaging/site/requirements.lock`; that lock was made by

    uv pip compile requirements.in --universal --python-version 3.11 --generate-hashes --no-annotate --no-header
        -o requirements.lock

Every warning ends it: a link that leads nowhere, a page that is in no list, what would be loaded from elsewhere. (A
script called `site.py` would come before Python's own module of that name.) `packaging/site/check_axe.mjs` looks at
the finished pages in a browser.
"""

import os
import shutil
import subprocess
import sys
import venv
from pathlib import Path

from setup_environment import ROOT, TESTED, SetUpError, prepare, say

BUILD = ROOT / "build" / "site"
PARTS = ROOT / "build" / "site-environment"
RECIPES = ROOT / "packaging" / "site"
LOCK = RECIPES / "requirements.lock"
STAMP = PARTS / "made-from"
LANGUAGES = {"en": "mkdocs.yml", "de": "mkdocs.de.yml"}


def main(arguments: list[str]) -> None:
    try:
        python = prepare(is_screen_needed=True, lock=TESTED)  # examples draw their figures
    except SetUpError as missing:
        sys.exit(str(missing))
    out = Path(arguments[0]).resolve() if arguments else ROOT / "dist" / "site"
    build(python, out)
    say(f"The site is in {out}.")


def build(python: Path, out: Path) -> None:
    """Put the pages together by the application's Python, and make the site of them in `out`."""
    packaging = ROOT / "packaging"
    # in the application's environment: the pages ask the code, and films, figures and outputs are made by it
    pages = "import sys, pathlib; from site_pages import assemble; assemble(pathlib.Path(sys.argv[1]))"
    _run(python, "-c", pages, BUILD)
    _run(python, packaging / "site_examples.py", BUILD / "en")
    _run(python, packaging / "site_figures.py", BUILD / "en" / "methods" / "figures")
    for language in LANGUAGES:
        films = BUILD / language / "manual" / "films"
        _run(python, packaging / "draw_films.py", films, "--lang", language)
    mkdocs = builder()
    shutil.rmtree(out, ignore_errors=True)
    for language, recipe in LANGUAGES.items():
        place = out if language == "en" else out / language
        # not quietly: what is not logged is not counted, and strict is then nothing
        command = [str(mkdocs), "build", "--strict", "--config-file", str(RECIPES / recipe)]
        # its makers' advertisement is none of ours; what is true of it is in packaging/site/requirements.in
        subprocess.run([*command, "--site-dir", str(place)], check=True, env={**os.environ, "NO_MKDOCS_2_WARNING": "1"})
    subprocess.run([sys.executable, str(packaging / "site_links.py"), str(out)], check=True)


def _run(python: Path, *command: str | Path) -> None:
    subprocess.run([str(python), *map(str, command)], cwd=ROOT / "packaging", check=True)


def builder() -> Path:
    """Give the command that builds, with its parts as the lock has them."""
    folder = PARTS / ("Scripts" if sys.platform == "win32" else "bin")
    if not STAMP.exists() or STAMP.read_bytes() != LOCK.read_bytes():
        shutil.rmtree(PARTS, ignore_errors=True)
        venv.create(PARTS, with_pip=True)
        pip = [str(folder / "python"), "-m", "pip", "--disable-pip-version-check", "install", "--quiet", "--no-deps"]
        subprocess.run([*pip, "--require-hashes", "--requirement", str(LOCK)], check=True)
        STAMP.write_bytes(LOCK.read_bytes())
    return folder / "mkdocs"


if __name__ == "__main__":
    main(sys.argv[1:])
