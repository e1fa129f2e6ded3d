"""Try what is installed on a Debian with nothing in it: `python3 -m tests.installation.try_bundle [--only NAME...]`

Takes what `packaging/build.py --with-tour` left in dist/ into a bare root (`bare_root.py`), as the package, then as the
archive. There an ordinary user makes the demonstration by the command line, has foreign files read and a batch done by
child processes, opens the window and ends it; then the tour leads the demonstration to its saved report in the very
folder that is installed. Removed again, nothing may be left but what the user has. Last a session is led, Rerun's
viewer included, where there is no network, under strace: it may call this computer only. Times are reported.

Needs root, debootstrap, Xvfb, openbox, xdotool, ImageMagick and strace.
"""

import argparse
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "packaging"))  # its scripts are no package

from setup_environment import ROOT, say

from tests.installation.bare_root import USER_ID, BareRoot, bare_root, enter_own_mounts, why_not
from tests.safety.no_network import ALONE, calls_in
from tests.tours import tour
from tests.tours.tour_stops import MOUSE, REVIEWED, Stop

DIST = ROOT / "dist"
PLACE = ROOT / "build" / "try" / "root"
AS_ROOT_ALONE = [word for word in ALONE if word != "--map-root-user"]  # who has no other user to become
INSTALLED = Path("/opt/gaitwright")
LOOK = ["light 1280x800@100"]
CALLS = ROOT / "build" / "try" / "calls"  # what strace noted, to look into
WINDOW_S = 60.0
PICTURES = ROOT / "build" / "try" / "pictures"
OF_OTHERS = re.compile(
    r"/(home|etc/ssl/certs|etc/ca-certificates.conf|usr/local/share/ca-certificates|var/lib/systemd)\b"
)


class TrialError(Exception):
    """Something does not work there; the message states what."""


def try_package(root: BareRoot) -> None:
    """Install both packages, use them, remove them; the first alone lacks Rerun's log and nothing else."""
    packages_made = sorted(DIST.glob("gaitwright*_*.deb"))
    root.apt("update")
    before, packages = root.files(), installed(root)
    for package in packages_made:
        shutil.copy(package, root.folder / "root")
    with reported("apt-get install"):
        root.apt("install", *(f"/root/{package.name}" for package in packages_made))
    use(root, "gaitwright", INSTALLED)
    root.apt("purge", "--autoremove", "gaitwright-rerun")
    answer = root.run("gaitwright", "demo", "--out", str(root.home / "without-rerun"))
    if "session.rrd was not written" not in answer:
        raise TrialError("Without Rerun the demonstration does not say what it lacks.")
    root.apt("purge", "--autoremove", "gaitwright")
    # what others recommend, apt keeps
    kept = sorted(installed(root) - packages)
    theirs = root.run("dpkg", "--listfiles", *kept, is_root=True).splitlines() if kept else []
    left = sorted(file for file in root.files() - before - {*theirs} if not OF_OTHERS.match(file))
    say(f"Removed. Of other packages are left: {kept}; of ours, outside the user's home: {left or 'nothing'}.")
    if left:
        raise TrialError("Something is left.")
    if not root.outside(root.home / "demonstration" / "report.pdf").is_file():
        raise TrialError("The user's report went with the program.")


def try_archive(root: BareRoot) -> None:
    """Unpack both archives in a home, with the libraries that the README names, use them, remove them."""
    root.apt("update")
    home = root.outside(root.home)
    with reported("unpacking"):
        for archive in DIST.glob("gaitwright-*.tar.zst"):
            subprocess.run(["tar", "--extract", "--zstd", "--file", archive, "--directory", home], check=True)
    (folder,) = home.glob("gaitwright-*")
    readme = (folder / "README.txt").read_text(encoding="utf-8")
    libraries = re.search(r"apt-get install (.+)", readme)
    if libraries is None:
        raise TrialError("README.txt names no libraries.")
    root.apt("install", "--no-install-recommends", *libraries[1].split())
    subprocess.run(["chown", "-R", f"{USER_ID}:{USER_ID}", folder], check=True)
    inside = root.home / folder.name
    use(root, str(inside / "gaitwright"), inside)
    shutil.rmtree(folder)
    say(f"Removed. In the user's home: {sorted(file.name for file in home.iterdir())}")


def try_alone(root: BareRoot) -> None:
    """Lead a session to Rerun's viewer and to the saved report where there is no network, and see whom it calls."""
    root.apt("update")
    made = sorted(DIST.glob("gaitwright*_*.deb"))
    for package in made:
        shutil.copy(package, root.folder / "root")
    root.apt("install", *(f"/root/{package.name}" for package in made))
    with tempfile.TemporaryDirectory(prefix="gaitwright-alone-") as folder:
        trace = Path(folder) / "calls"
        subprocess.run(
            [*AS_ROOT_ALONE, sys.executable, "-m", __spec__.name, "--inside", str(root.folder), str(trace)],
            cwd=ROOT,
            check=True,
            timeout=900.0,
        )
        shutil.copy(trace, CALLS)
    text = CALLS.read_text(encoding="utf-8", errors="replace")
    calls = calls_in(text)
    families = ", ".join(f"{family} {count}" for family, count in calls.families.items())
    bound = sorted({line.partition("bind(")[2] for line in text.splitlines() if "bind(" in line and "AF_INET" in line})
    say(f"Called: {families}; others: {', '.join(sorted(calls.addresses)) or 'none'}.\nWaited at: {bound or 'nothing'}")
    if calls.outside:
        raise TrialError("\n".join(calls.outside))
    if not calls.families["AF_UNIX"]:
        raise TrialError("strace saw nothing")
    strangers = [line for line in bound if "127.0.0.1" not in line and '"::1"' not in line and "10000" not in line]
    if strangers:  # sensors announce themselves at port 10000
        raise TrialError(f"It can be called from elsewhere: {strangers}")


TRIALS: dict[str, Callable[[BareRoot], None]] = {"package": try_package, "archive": try_archive, "alone": try_alone}


def use(root: BareRoot, program: str, place: Path) -> None:
    """Do what a user does, by the command line and in the window, with the program that lies in `place`."""
    say(f"{root.run(program, '--version').strip()}")
    with reported("demo, to a report"):
        root.run(program, "demo", "--out", "demonstration")
    report = root.outside(root.home / "demonstration" / "report.pdf")
    if not report.read_bytes().startswith(b"%PDF"):
        raise TrialError("The report is none.")
    with reported("analyse (a child reads the files)"):
        root.run(program, "analyse", "demonstration/session", "--out", "analysed")
    same = [root.outside(root.home / folder / "summary.json").read_bytes() for folder in ("demonstration", "analysed")]
    if same[0] != same[1]:
        raise TrialError("analyse and demo give other results.")
    root.run("sh", "-c", "mkdir -p many && cp -r demonstration/session many/a && cp -r demonstration/session many/b")
    with reported("batch with two workers"):
        root.run(program, "batch", "many", "--out", "table", "--workers", "2")
    root.run(program, "query", "select count(*) from parameters", "--in", "table/parameters.parquet")
    root.run(program, "export", "demonstration/session", "--as", "xlsx,c3d,mot,fhir,bids-motion", "--out", "exported")
    with tour.own_display() as display:
        open_and_close(root, program, display)
    with reported("tour: the demonstration to its saved report"):
        lead(root, place, MOUSE)


def installed(root: BareRoot) -> set[str]:
    return set(root.run("dpkg-query", "--show", "--showformat=${Package}\n", is_root=True).split())


def open_and_close(root: BareRoot, program: str, display: str) -> None:
    """Open the window, see it on the display, close it as a window manager does."""
    environment = {**os.environ, "DISPLAY": display}
    began_s = time.monotonic()
    process = subprocess.Popen(root_command(root, display, program), env={"HOME": str(root.home)})
    try:
        search = ["xdotool", "search", "--onlyvisible", "--name", "^Gaitwright"]
        while (found := subprocess.run(search, env=environment, capture_output=True, text=True)).returncode != 0:
            if process.poll() is not None or time.monotonic() - began_s > WINDOW_S:
                raise TrialError("No window came.")
            time.sleep(0.05)
        say(f"The window is there {time.monotonic() - began_s:.1f} s after its start.")
        time.sleep(3.0)
        PICTURES.mkdir(parents=True, exist_ok=True)
        number = found.stdout.split()[0]
        for does in (
            ("import", "-window", number, str(PICTURES / "window.png")),
            ("xdotool", "windowactivate", "--sync", number),
            ("xdotool", "key", "alt+F4"),
        ):
            subprocess.run(does, env=environment, check=True)
        if process.wait(timeout=30) != 0:
            raise TrialError(f"The window ended with {process.returncode}.")
    finally:
        if process.poll() is None:
            process.kill()
            process.wait()


def lead(root: BareRoot, place: Path, stops: Sequence[Stop], trace: Path | None = None) -> None:
    """Lead a tour with the program that `build.py --with-tour` made, which runs in the installed folder."""
    guide = root.outside(place) / "gaitwright-tour"
    shutil.copy(DIST / "gaitwright-tour", guide)
    try:
        with tour.own_display() as display:
            command = [*tour.tracer(trace), *root_command(root, display, str(place / "gaitwright-tour"))]
            with tour.running(display, command, USER_ID) as application:
                pictures = application.home / "pictures"
                for place in (pictures, pictures / LOOK[0].replace(" ", "-")):
                    place.mkdir()
                    os.chown(place, USER_ID, USER_ID)
                stopwatch_s = tour.lead(application, stops, pictures, LOOK).stopwatch_s
                saved = [file.name for file in application.home.rglob("*.pdf")]
                shutil.copytree(pictures, PICTURES, dirs_exist_ok=True)
    finally:
        guide.unlink()
    if not saved:
        raise TrialError("The tour left no report.")
    say(f"{len(stops)} stops, {stopwatch_s:.0f} s of the application's stopwatch; saved: {saved}")


def root_command(root: BareRoot, display: str, program: str) -> list[str]:
    """Run a program with a window inside. It has this process's environment: homes of a tour are in /tmp, shared."""
    return [
        *("env", "PATH=/usr/sbin:/usr/bin:/sbin:/bin", f"DISPLAY={display}", "QT_QPA_PLATFORM=xcb", "LANG=C.UTF-8"),
        *("chroot", f"--userspec={USER_ID}:{USER_ID}", str(root.folder)),
        *("sh", "-c", 'cd "$HOME" && exec "$@"', "sh", program),
    ]


@contextmanager
def reported(what: str) -> Iterator[None]:
    began_s = time.monotonic()
    yield
    say(f"{what}: {time.monotonic() - began_s:.1f} s")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument(
        "--only", nargs="+", choices=TRIALS, default=list(TRIALS), metavar="NAME", help="/".join(TRIALS)
    )
    parser.add_argument("--inside", nargs=2, help=argparse.SUPPRESS)
    required = parser.parse_args()
    if required.inside:
        lead(BareRoot(Path(required.inside[0])), INSTALLED, REVIEWED, Path(required.inside[1]))
        return
    if reason := why_not():
        sys.exit(f"This cannot be tried here: {reason}.")
    enter_own_mounts(__spec__.name)
    if not list(DIST.glob("gaitwright_*.deb")) or not (DIST / "gaitwright-tour").exists():
        sys.exit("Run first: python3 packaging/build.py --with-tour")
    for name in required.only:
        say(f"== {name}")
        with bare_root(PLACE) as root, reported(name):
            TRIALS[name](root)


if __name__ == "__main__":
    try:
        main()
    except (TrialError, RuntimeError, tour.TourError) as failure:
        sys.exit(str(failure))
