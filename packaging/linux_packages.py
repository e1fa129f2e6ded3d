"""Packs the frozen folder for Linux: an archive to unpack anywhere, and a package of Debian's kind.

Rerun is a third of it and in an archive and a package of its own, which the other recommends, and apt so installs.

The package puts the folder into /opt/gaitwright, `gaitwright` into /usr/bin and one entry into the desktop's menu. It
has no scripts: what it put there dpkg takes away again, and nothing else. What users recorded is in their homes.
"""

import platform
import shutil
import subprocess
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path

from setup_environment import QT_LIBRARIES, ROOT

INSTALLERS = ROOT / "packaging" / "installers"
PLACE = Path("opt/gaitwright")
LEVEL = 12  # of zstd: more takes minutes for a few per cent
FORMERLY = {"libglib2.0-0": "libglib2.0-0 | libglib2.0-0t64"}  # what later releases call it
OTHERS = ("libstdc++6", "libgcc-s1", "libx11-6", "libxcb1", "libfreetype6", "zlib1g")
RERUN = "_internal/rerun"  # how the names of its parts begin
# for its viewer, which looks for them when it starts
OF_VIEWER = (
    *("libgl1-mesa-dri", "mesa-vulkan-drivers", "libvulkan1", "libx11-xcb1", "libxcursor1", "libxi6", "libxrandr2"),
)
FONTS = "fonts-noto-core"  # for names in any script
HEAD = """\
Package: {package}
Version: {version}
Architecture: {architecture}
Maintainer: The authors of Gaitwright <gaitwright@example.invalid>
Installed-Size: {kilobytes}
Depends: {depends}
Recommends: {recommends}
Section: science
Priority: optional
"""
DESCRIPTION = """\
Description: knee and ankle angles from motion sensors worn in any orientation
 For physiotherapists and prosthetists: sensors on thigh, shank and foot show how
 knee and ankle bend while a patient walks, with the certainty of every curve.
 It needs no magnetometer, no posed calibration and no network.
 .
 Research use. Not a medical device.
"""
DESCRIPTION_OF_RERUN = """\
Description: sessions of Gaitwright in Rerun
 Rerun and its viewer, with which Gaitwright shows recordings beside moving legs.
 Without it Gaitwright lacks this view and the file session.rrd, and nothing else.
"""


def make_archives(folder: Path, version: str, out: Path) -> Iterator[Path]:
    """Pack the folder, with what to do with it, and Rerun for the same place, and give both archives."""
    name = f"gaitwright-{version}"
    (folder / "README.txt").write_text(readme(), encoding="utf-8")
    of_rerun: list[str | Path] = [
        f"{folder.name}/{path.relative_to(folder)}" for path in sorted(folder.glob(f"{RERUN}*"))
    ]
    without = [part for path in of_rerun for part in ("--exclude", path)]
    whole: list[str | Path] = [*without, folder.name]
    for package, parts in (("gaitwright", whole), ("gaitwright-rerun", of_rerun)):
        archive = out / f"{package}-{version}-linux-{platform.machine()}.tar.zst"
        subprocess.run(
            [
                *("tar", "--create", "--file", archive, "--use-compress-program", f"zstd -{LEVEL} -T0 -q"),
                *("--sort=name", "--owner=0", "--group=0", "--numeric-owner", "--mode=u=rwX,go=rX"),
                *("--transform", f"s,^{folder.name},{name},", "--directory", folder.parent, *parts),
            ],
            check=True,
        )
        yield archive


def readme() -> str:
    """Describe what to do with the archive, and name the libraries as Debian does on the day of the build."""
    names = " ".join(name.partition(" | ")[0] for name in depends())
    return (INSTALLERS / "archive.txt").read_text(encoding="utf-8").replace("{libraries}", names)


def make_debs(folder: Path, version: str, out: Path) -> Iterator[Path]:
    """Pack the folder as two packages, and give them."""
    architecture = subprocess.run(
        ["dpkg", "--print-architecture"], check=True, capture_output=True, text=True
    ).stdout.strip()
    for package, put, stated in (
        ("gaitwright", lay_out, control),
        ("gaitwright-rerun", lay_out_rerun, control_of_rerun),
    ):
        file = out / f"{package}_{version}_{architecture}.deb"
        with tempfile.TemporaryDirectory(prefix="package-", dir=folder.parent) as temporary:
            root = Path(temporary)
            root.chmod(0o755)
            put(folder, root)
            (root / "DEBIAN").mkdir()
            (root / "DEBIAN" / "control").write_text(stated(version, architecture, root), encoding="utf-8")
            subprocess.run(
                [*("dpkg-deb", "--root-owner-group", "-Zzstd", f"-z{LEVEL}"), "--build", root, file],
                check=True,
                stdout=subprocess.DEVNULL,
            )
        yield file


def lay_out(folder: Path, root: Path) -> None:
    """Put every file where it is installed. The folder's own are linked, not copied: there is a gigabyte of them."""
    shutil.copytree(folder, root / PLACE, symlinks=True, copy_function=_link, ignore=_rerun_in(folder))
    program = root / "usr/bin/gaitwright"
    program.parent.mkdir(parents=True)
    program.symlink_to(f"/{PLACE}/gaitwright")
    for file, place in (
        ("gaitwright.desktop", "usr/share/applications/gaitwright.desktop"),
        ("gaitwright.svg", "usr/share/icons/hicolor/scalable/apps/gaitwright.svg"),
        ("copyright", "usr/share/doc/gaitwright/copyright"),
    ):
        target = root / place
        target.parent.mkdir(parents=True)
        shutil.copyfile(INSTALLERS / file, target)
        target.chmod(0o644)


def lay_out_rerun(folder: Path, root: Path) -> None:
    """Put what is Rerun's where the other package has the rest, and its licence where packages have theirs."""
    for part in sorted(folder.glob(f"{RERUN}*")):
        shutil.copytree(part, root / PLACE / part.relative_to(folder), symlinks=True, copy_function=_link)
    target = root / "usr/share/doc/gaitwright-rerun/copyright"
    target.parent.mkdir(parents=True)
    shutil.copyfile(INSTALLERS / "copyright", target)
    target.chmod(0o644)


def control(version: str, architecture: str, root: Path) -> str:
    head = HEAD.format(
        package="gaitwright",
        version=version,
        architecture=architecture,
        kilobytes=_kilobytes(root),
        depends=", ".join([f"libc6 (>= {platform.libc_ver()[1]})", *depends()]),
        recommends=f"gaitwright-rerun (= {version}), {FONTS}",
    )
    return head + DESCRIPTION


def control_of_rerun(version: str, architecture: str, root: Path) -> str:
    head = HEAD.format(
        package="gaitwright-rerun",
        version=version,
        architecture=architecture,
        kilobytes=_kilobytes(root),
        depends=f"gaitwright (= {version})",
        recommends=", ".join(OF_VIEWER),
    )
    # before there were two, its files were the other's
    taken = f"Breaks: gaitwright (<< {version})\nReplaces: gaitwright (<< {version})\n"
    return head + taken + DESCRIPTION_OF_RERUN


def _kilobytes(root: Path) -> int:
    sizes = (file.stat().st_size for file in root.rglob("*") if file.is_file() and not file.is_symlink())
    return sum(-(-size // 1024) for size in sizes)


def _rerun_in(folder: Path) -> Callable[[str, list[str]], list[str]]:
    """Leave out of a copy of `folder` what is Rerun's."""
    inside, _, begin = RERUN.rpartition("/")
    return lambda place, names: [one for one in names if Path(place) == folder / inside and one.startswith(begin)]


def depends() -> list[str]:
    """Debian's names of what is left to the system."""
    return [FORMERLY.get(name, name) for name in (*QT_LIBRARIES.values(), *OTHERS)]


def _link(source: str, target: str) -> str:
    Path(target).hardlink_to(source)
    return target
