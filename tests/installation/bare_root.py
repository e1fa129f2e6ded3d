"""A Debian with nothing in it, in a folder: what is tried there finds only what it brings itself.

Needs debootstrap and to be root. The packages come from where this machine's apt has them from. The root shares /tmp,
devices and the network with this machine, so that a display that is outside can be seen inside.
"""

import os
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "packaging"))  # its scripts are no package

from setup_environment import say

RELEASE = "bookworm"
OF_NETWORK = (
    "HTTP_PROXY",
    "HTTPS_PROXY",
    "NO_PROXY",
    "PIP_INDEX_URL",
    "PIP_DEFAULT_TIMEOUT",
    "SSL_CERT_FILE",
)
NEEDED = ("debootstrap", "chroot", "mount", "unshare")
OWN_MOUNTS = "GAITWRIGHT_OWN_MOUNTS"
USER, USER_ID = "clinician", 1000
MOUNTED = ("/proc", "/sys", "/dev", "/tmp")
CERTIFICATES = Path("/usr/local/share/of-this-network.crt")  # where no package of Debian's writes
OF_APT = re.compile(
    r"/(var/(lib|cache|log)/(apt|dpkg|debconf)|var/log|var/cache|run|root|etc/ld\.so\.cache|proc|sys|dev|tmp)\b"
)


class BareRoot:
    """The root in `folder`. Commands run in it as root or as an ordinary user."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    @property
    def home(self) -> Path:
        """Of the ordinary user, as it is inside."""
        return Path("/home") / USER

    def outside(self, place: Path) -> Path:
        """Where a place inside is outside."""
        return self.folder / place.relative_to("/")

    def command(self, *words: str, is_root: bool = False) -> list[str]:
        """What runs `words` inside, from the user's home."""
        user = [] if is_root else [f"--userspec={USER_ID}:{USER_ID}"]
        home = "/root" if is_root else str(self.home)
        clean = ["env", "-i", "PATH=/usr/local/bin:/usr/bin:/bin:/usr/sbin:/sbin", "LANG=C.UTF-8", f"HOME={home}"]
        kept = [f"{name}={value}" for name, value in os.environ.items() if name.upper() in OF_NETWORK]
        kept += [f"PIP_CERT={CERTIFICATES}"] if self.outside(CERTIFICATES).is_file() else []
        inside = ["sh", "-c", 'cd "$HOME" && exec "$@"', "sh", *words]
        return ["chroot", *user, str(self.folder), *clean, *kept, *inside]

    def run(self, *words: str, is_root: bool = False, most_s: float = 900.0) -> str:
        """Run it to its end and give what it printed."""
        try:
            done = subprocess.run(
                self.command(*words, is_root=is_root),
                stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=most_s,
            )  # fmt: skip
        except subprocess.TimeoutExpired as late:
            raise RuntimeError(f"{' '.join(words)}: not done in {most_s:.0f} s") from late
        if done.returncode != 0:
            raise RuntimeError(f"{' '.join(words)}: {done.returncode}\n{done.stdout[-3000:]}")
        return done.stdout

    def apt(self, *words: str) -> str:
        return self.run("env", "DEBIAN_FRONTEND=noninteractive", "apt-get", "-y", "-q", *words, is_root=True)

    def files(self) -> frozenset[str]:
        """Every file but what apt and dpkg keep for themselves."""
        shared = [word for place in MOUNTED for word in ("-path", f".{place}", "-prune", "-o")]
        found = subprocess.run(
            ["find", ".", *shared, "-printf", "/%P\n"], cwd=self.folder, check=True, stdout=subprocess.PIPE, text=True
        )
        return frozenset(line for line in found.stdout.splitlines() if not OF_APT.match(line))


def why_not() -> str:
    """Why none can be made here; empty where it can."""
    if os.geteuid() != 0:
        return "only root can make a root of its own"
    missing = [name for name in NEEDED if shutil.which(name) is None]
    return f"{', '.join(missing)} is not there" if missing else ""


def enter_own_mounts(module: str) -> None:
    """Begin `module` again where mounts are its own: however it ends, this machine's /dev is left in no folder.

    Whoever removed such a folder would remove the devices and temporary files of the machine.
    """
    if os.environ.get(OWN_MOUNTS):
        return
    os.environ[OWN_MOUNTS] = "1"
    again = ["unshare", "--mount", "--propagation", "slave", sys.executable, "-m", module, *sys.argv[1:]]
    os.execvp(again[0], again)


@contextmanager
def bare_root(folder: Path) -> Iterator[BareRoot]:
    """Make a root in `folder`, which is gone afterwards; what is made from is kept beside it for the next time.

    Raises RuntimeError outside mounts of its own (`enter_own_mounts`).
    """
    if not os.environ.get(OWN_MOUNTS):
        raise RuntimeError("a bare root is made where mounts are its own only")
    base = folder.with_name(f"{RELEASE}.tar")
    if not base.exists():
        say("Making a bare Debian.")
        _make(folder, base)
    _clear(folder)
    folder.mkdir(parents=True)
    with ExitStack() as stack:
        stack.callback(_clear, folder)
        subprocess.run(["tar", "--extract", "--numeric-owner", "--file", base, "--directory", folder], check=True)
        for place in MOUNTED:
            inside = folder / place.lstrip("/")
            subprocess.run(["mount", "--rbind", "--make-rslave", place, inside], check=True)
            stack.callback(_unmount, inside)
        shutil.copyfile("/etc/resolv.conf", folder / "etc/resolv.conf")
        # every installed system has it, a bare one asks a server of names for localhost
        (folder / "etc/hosts").write_text("127.0.0.1 localhost\n::1 localhost ip6-localhost\n", encoding="ascii")
        root = BareRoot(folder)
        root.run("useradd", "--uid", str(USER_ID), "--create-home", USER, is_root=True)
        if own := os.environ.get("PIP_CERT"):
            shutil.copyfile(own, root.outside(CERTIFICATES))
        yield root


def _make(folder: Path, base: Path) -> None:
    _clear(folder)
    folder.mkdir(parents=True)
    subprocess.run(
        ["debootstrap", "--variant=minbase", RELEASE, folder, _mirror()],
        check=True,
        stdout=subprocess.DEVNULL,
    )
    sources = folder / "etc/apt"
    (sources / "sources.list").unlink(missing_ok=True)
    for place in ("sources.list", "sources.list.d"):
        if (ours := Path("/etc/apt") / place).is_dir():
            shutil.copytree(ours, sources / place, dirs_exist_ok=True)
        elif ours.is_file():
            shutil.copyfile(ours, sources / place)
    for settings in Path("/etc/apt/apt.conf.d").iterdir():  # how this network is reached
        if "Acquire::" in settings.read_text(encoding="utf-8"):
            shutil.copy(settings, sources / "apt.conf.d")
    beside = base.with_suffix(".new")
    subprocess.run(["tar", "--create", "--numeric-owner", "--file", beside, "--directory", folder, "."], check=True)
    beside.replace(base)
    _clear(folder)


def _mirror() -> str:
    """Where this machine's apt has its packages from."""
    files = [Path("/etc/apt/sources.list"), *Path("/etc/apt/sources.list.d").glob("*.sources")]
    files += sorted(Path("/etc/apt/sources.list.d").glob("*.list"))
    text = "\n".join(file.read_text(encoding="utf-8") for file in files if file.is_file())
    found = re.search(r"^(?:URIs:|deb(?: \[[^]]*\])?)\s+(\S+)", text, re.MULTILINE)
    if found is None:
        raise RuntimeError("apt has no source of packages here")
    return found[1]


def _unmount(place: Path) -> None:
    subprocess.run(["umount", "--recursive", "--lazy", place], stderr=subprocess.DEVNULL)


def _clear(folder: Path) -> None:
    """Remove it, unless something is still mounted in it."""
    for line in Path("/proc/self/mountinfo").read_text(encoding="utf-8").splitlines():
        if line.split()[4].startswith(f"{folder.resolve()}/"):
            _unmount(Path(line.split()[4]))
    subprocess.run(["rm", "-rf", "--one-file-system", str(folder)], check=True)
