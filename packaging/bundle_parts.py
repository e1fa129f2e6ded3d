"""Owners and licences of the parts in the folder that PyInstaller made. Run by the environment that made it.

    build/environment/bin/python packaging/bundle_parts.py WORK FOLDER SBOM

What is inside is read from PyInstaller's own lists of where each file and module came from, so that nothing is listed
that is not there and nothing is there that is not listed. Each part's licence texts are put into FOLDER/licences with a
table of all; a part without a text stops the build, since its licence forbids to give it away so. The bill of materials
(CycloneDX) is that of the environment, less what built it, and with Python itself and the system's libraries.
"""

import ast
import csv
import json
import re
import shutil
import subprocess
import sys
import sysconfig
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
TEXTS_OF_OURS = ROOT / "packaging" / "installers" / "licences"  # of parts that come without
TEXT = re.compile(r"(licen[cs]e|copying|notice|third.?party|authors)", re.IGNORECASE)
TEXT_ENDINGS = ("", ".txt", ".md", ".rst", ".apache", ".mit", ".bsd", ".lesser")
LICENCES = {
    "ezc3d": "MIT",
    "sqlcipher3": "Zlib; SQLCipher: BSD-3-Clause",
}  # by their texts; they do not say it in words
HOMES = ("homepage", "home", "repository", "source", "source code", "github")
COPYRIGHT = Path("/usr/share/doc")  # Debian's
TOOL_INSIDE = "pyinstaller"  # what starts the program is its own


class PartsError(Exception):
    """The folder may not be given to anybody so; the message states why."""


@dataclass(frozen=True, slots=True)
class Part:
    """Something that somebody else made: name, version, licence in words, where it is at home, and its texts."""

    name: str
    version: str
    licence: str
    home: str
    texts: tuple[Path, ...]
    kind: str = "pypi"  # as a package URL names it


def sources(work: Path) -> Iterator[Path]:
    """Give where everything in the folder came from, by PyInstaller's lists COLLECT and PYZ."""
    for file in sorted(work.glob("*.toc")):
        if not file.name.startswith(("COLLECT", "PYZ")):
            continue
        reported = ast.literal_eval(file.read_text(encoding="utf-8"))
        for entries in reported:
            if isinstance(entries, list):
                yield from (
                    Path(source) for _, source, kind in entries if kind != "SYMLINK" and source not in ("", "-")
                )


def owners() -> dict[str, str]:
    """Give the distribution of every installed file, by its resolved path."""
    return {
        str(Path(str(one.locate_file(file))).resolve()): one.name
        for one in metadata.distributions()
        for file in one.files or ()
    }


def sorted_out(files: Iterable[Path], owned: dict[str, str], stdlib: Path) -> tuple[set[str], set[Path]]:
    """Sort files into distributions and system paths; raises PartsError for a file of none among the former."""
    names, system = set(), set()
    made_here = (ROOT / "build", stdlib.resolve(), ROOT)
    packages = Path(sysconfig.get_path("purelib")).resolve()
    for file in files:
        place = file.resolve()
        if (name := owned.get(str(place))) is not None:
            names.add(name)
        elif place.is_relative_to(packages):
            raise PartsError(f"{place} is in the folder and belongs to no distribution.")
        elif not any(place.is_relative_to(folder) for folder in made_here) and "libpython" not in place.name:
            system.add(place)
    return names, system


def part_of(name: str) -> Part:
    """Read a distribution's metadata and licence texts; raises PartsError where there is no text."""
    one = metadata.distribution(name)
    reported = one.metadata

    def first(field: str) -> str:
        return str((reported.get_all(field) or ("",))[0]).strip()

    names = [
        line.rpartition(" :: ")[2] for line in reported.get_all("Classifier") or () if line.startswith("License ::")
    ]
    stated = first("License")
    licence = first("License-Expression") or (stated if stated and "\n" not in stated else "") or ", ".join(names)
    licence = licence or LICENCES.get(name, "")
    urls = [value.partition(", ") for value in reported.get_all("Project-URL") or ()]
    homes = [url for label, _, url in urls if label.lower() in HOMES] + [url for _, _, url in urls]
    texts = [
        Path(str(one.locate_file(file)))
        for file in one.files or ()
        if file.suffix.lower() in TEXT_ENDINGS and (TEXT.match(file.name) or "licenses" in file.parts)
    ]
    texts += sorted((TEXTS_OF_OURS / re.sub("[-_.]+", "-", name).lower()).glob("*"))
    if not texts or not licence:
        raise PartsError(f"{name} {one.version}: no licence or no text of it. Put its text into {TEXTS_OF_OURS}.")
    return Part(name, one.version, licence, first("Home-page") or next(iter(homes), ""), tuple(texts))


def part_of_python() -> Part:
    version = ".".join(map(str, sys.version_info[:3]))
    places = (Path(sysconfig.get_path("stdlib")) / "LICENSE.txt", Path(sys.base_prefix) / "LICENSE.txt")
    texts = tuple(place for place in places if place.is_file())
    # Debian keeps it elsewhere
    texts = texts or tuple((COPYRIGHT / f"python{version.rpartition('.')[0]}").glob("copyright"))
    if not texts:
        raise PartsError("The licence of Python was not found.")
    return Part("python", version, "PSF-2.0", "https://www.python.org", texts[:1], kind="generic")


def system_parts(files: Iterable[Path]) -> Iterator[Part]:
    """Give the Debian packages of these libraries; raises PartsError where one is unknown."""
    for file in sorted(files):
        asked = [str(file), str(file).removeprefix("/usr")]
        found = next((answer for path in asked if (answer := _reported_by("dpkg-query", "--search", path))), "")
        package = found.partition(": ")[0].partition(",")[0].partition(":")[0]
        text = COPYRIGHT / package / "copyright"
        if not package or not text.is_file():
            raise PartsError(f"{file} comes from no package that is known here.")
        version = _reported_by("dpkg-query", "--show", "--showformat=${Version}", package)
        home = _reported_by("dpkg-query", "--show", "--showformat=${Homepage}", package)
        yield Part(package, version, "see its text", home, (text,), kind="deb/debian")


def write_licences(parts: Iterable[Part], folder: Path) -> None:
    """Put the texts into folders named after the parts, and a table of all beside them."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    with (folder / "parts.csv").open("w", encoding="utf-8", newline="") as table:
        rows = csv.writer(table)
        rows.writerow(("part", "version", "licence", "home"))
        for part in parts:
            rows.writerow((part.name, part.version, part.licence, part.home))
            place = folder / f"{part.name}-{part.version}".replace(":", "_")
            place.mkdir(exist_ok=True)
            for text in part.texts:
                _copy_beside(text, place)


def bill_of_materials(whole: dict[str, Any], parts: Iterable[Part]) -> dict[str, Any]:
    """Leave in an environment's CycloneDX bill what is inside, and add what is no distribution."""
    inside = {_key(part.name): part for part in parts}
    components = [one for one in whole.get("components", ()) if _key(one["name"]) in inside]
    listed = {_key(one["name"]) for one in components}
    for key, part in inside.items():
        if key not in listed:
            url = f"pkg:{part.kind}/{part.name}@{part.version.replace(':', '%3A').replace('+', '%2B')}"
            components += [{"type": "library", "bom-ref": url, "name": part.name, "version": part.version, "purl": url}]
    own = whole.get("metadata", {}).get("component", {}).get("bom-ref")
    known = {one["bom-ref"] for one in components} | {own}
    dependencies = [
        one | ({"dependsOn": kept} if (kept := [ref for ref in one.get("dependsOn", ()) if ref in known]) else {})
        for one in whole.get("dependencies", ())
        if one["ref"] in known
    ]
    for one in dependencies:
        if not any(ref in known for ref in one.get("dependsOn", ())):
            one.pop("dependsOn", None)
    return {**whole, "components": components, "dependencies": dependencies}


def environment_bill() -> dict[str, Any]:
    """Ask cyclonedx-py what is installed here."""
    done = subprocess.run(
        [
            *(sys.executable, "-m", "cyclonedx_py", "environment", "--output-reproducible", "--mc-type", "application"),
            *("--pyproject", str(ROOT / "pyproject.toml"), "--output-format", "JSON", sys.executable),
        ],
        check=True,
        stdout=subprocess.PIPE,
        text=True,
    )
    return dict(json.loads(done.stdout))


def check_bill(bill: str) -> None:
    """Hold a bill to the schema; raises PartsError where it does not follow it."""
    from cyclonedx.schema import SchemaVersion
    from cyclonedx.validation.json import JsonStrictValidator

    version = SchemaVersion.from_version(json.loads(bill)["specVersion"])
    if (problem := JsonStrictValidator(version).validate_str(bill)) is not None:
        raise PartsError(f"The bill of materials does not follow its schema: {problem}")


def main(work: Path, folder: Path, sbom: Path) -> None:
    names, system = sorted_out(sources(work), owners(), Path(sysconfig.get_path("stdlib")))
    names = (names | {TOOL_INSIDE}) - {"gaitwright"}
    problems, parts = [], [part_of_python()]
    for name in sorted(names, key=str.lower):
        try:
            parts.append(part_of(name))
        except PartsError as problem:
            problems.append(str(problem))
    if problems:
        raise PartsError("\n".join(problems))
    parts += {part.name: part for part in system_parts(system)}.values()
    write_licences(parts, folder / "licences")
    shutil.copy(ROOT / "LICENSE", folder / "LICENSE")
    bill = json.dumps(bill_of_materials(environment_bill(), parts), indent=1, sort_keys=True)
    check_bill(bill)
    sbom.write_text(bill + "\n", encoding="utf-8")
    print(f"{len(parts)} parts with their licences, {sbom.name}.")


def _copy_beside(text: Path, place: Path) -> None:
    target = place / text.name
    number = 1
    while target.exists():
        if target.read_bytes() == text.read_bytes():
            return
        number += 1
        target = place / f"{text.stem}-{number}{text.suffix}"
    shutil.copyfile(text, target)


def _key(name: str) -> str:
    return re.sub("[-_.]+", "-", name).lower()


def _reported_by(*command: str) -> str:
    try:
        done = subprocess.run(command, capture_output=True, text=True)
    except FileNotFoundError:
        return ""
    return done.stdout.strip() if done.returncode == 0 else ""


if __name__ == "__main__":
    try:
        main(*map(Path, sys.argv[1:4]))
    except PartsError as refusal:
        sys.exit(str(refusal))
