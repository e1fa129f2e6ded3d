"""Packs the frozen folder for Linux: an archive to unpack anywhere, and a package of Debian's kind.

The package puts the folder into /opt/gaitwright, `gaitwright` into /usr/bin and one entry into the desktop's menu. It
has no scripts: what it put there dpkg takes away again, and nothing else. What users recorded is in their homes.
"""

import platform
import shutil
import subprocess
import tempfile
from pathlib import Path

from setup_environment import QT_LIBRARIES, ROOT

INSTALLERS = ROOT / "packaging" / "installers"
PLACE = Path("opt/gaitwright")
LEVEL = 12  # of zstd: more takes minutes for a few per cent
FORMERLY = {"libglib2.0-0": "libglib2.0-0 | libglib2.0-0t64"}  # what later releases call it
OTHERS = ("libstdc++6", "libgcc-s1", "libx11-6", "libxcb1", "libfreetype6", "zlib1g")
# for Rerun's viewer, which looks for them when it starts, and for names in any script
RECOMMENDED = (
    *("libgl1-mesa-dri", "mesa-vulkan-drivers", "libvulkan1", "libx11-xcb1", "libxcursor1", "libxi6", "libxrandr2"),
    "fonts-noto-core",
)
CONTROL = """\
Package: gaitwright
Version: {version}
Architecture: {architecture}
Maintainer: The authors of Gaitwright <gaitwright@example.invalid>
Installed-Size: {kilobytes}
Depends: {depends}
Recommends: {recommends}
Section: science
Priority: optional
Description: knee and ankle angles from motion sensors worn in any orientation
 For physiotherapists and prosthetists: sensors on thigh, shank and foot show how
 knee and ankle bend while a patient walks, with the certainty of every curve.
 It needs no magnetometer, no posed calibration and no network.
 .
 Research use. Not a medical device.
"""


def make_archive(folder: Path, version: str, out: Path) -> Path:
    """Pack the folder, with what to do with it, into one archive, and give that."""
    name = f"gaitwright-{version}"
    archive = out / f"{name}-linux-{platform.machine()}.tar.zst"
    (folder / "README.txt").write_text(readme(), encoding="utf-8")
    subprocess.run(
        [
            *("tar", "--create", "--file", archive, "--use-compress-program", f"zstd -{LEVEL} -T0 -q"),
            *("--sort=name", "--owner=0", "--group=0", "--numeric-owner", "--mode=u=rwX,go=rX"),
            *("--transform", f"s,^{folder.name},{name},", "--directory", folder.parent, folder.name),
        ],
        check=True,
    )
    return archive


def readme() -> str:
    """Describe what to do with the archive, and name the libraries as Debian does on the day of the build."""
    names = " ".join(name.partition(" | ")[0] for name in depends())
    return (INSTALLERS / "archive.txt").read_text(encoding="utf-8").replace("{libraries}", names)


def make_deb(folder: Path, version: str, out: Path) -> Path:
    """Pack the folder as a package, and give that."""
    architecture = subprocess.run(
        ["dpkg", "--print-architecture"], check=True, capture_output=True, text=True
    ).stdout.strip()
    package = out / f"gaitwright_{version}_{architecture}.deb"
    with tempfile.TemporaryDirectory(prefix="package-", dir=folder.parent) as temporary:
        root = Path(temporary)
        root.chmod(0o755)
        lay_out(folder, root)
        (root / "DEBIAN").mkdir()
        (root / "DEBIAN" / "control").write_text(control(version, architecture, root), encoding="utf-8")
        subprocess.run(
            [*("dpkg-deb", "--root-owner-group", "-Zzstd", f"-z{LEVEL}"), "--build", root, package],
            check=True,
            stdout=subprocess.DEVNULL,
        )
    return package


def lay_out(folder: Path, root: Path) -> None:
    """Put every file where it is installed. The folder's own are linked, not copied: there is a gigabyte of them."""
    shutil.copytree(folder, root / PLACE, symlinks=True, copy_function=_link)
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


def control(version: str, architecture: str, root: Path) -> str:
    sizes = (file.stat().st_size for file in root.rglob("*") if file.is_file() and not file.is_symlink())
    return CONTROL.format(
        version=version,
        architecture=architecture,
        kilobytes=sum(-(-size // 1024) for size in sizes),
        depends=", ".join([f"libc6 (>= {platform.libc_ver()[1]})", *depends()]),
        recommends=", ".join(RECOMMENDED),
    )


def depends() -> list[str]:
    """Debian's names of what is left to the system."""
    return [FORMERLY.get(name, name) for name in (*QT_LIBRARIES.values(), *OTHERS)]


def _link(source: str, target: str) -> str:
    Path(target).hardlink_to(source)
    return target
