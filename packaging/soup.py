"""Make the list of parts that others made: `python packaging/soup.py`.

`packaging/safety/soup.toml` gives for each why it is there, what fails if it is wrong, and which anomalies are known;
the locks of `packaging`, that of development and that of what `start.py` installs, have its version. Together they are
`packaging/safety/soup.md`. A locked part that is in neither list of the TOML, or one that is not locked, is reported
and nothing is written.
"""

import re
import sys
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
SAFETY = ROOT / "packaging" / "safety"
LOCKS = ("requirements.lock", "runtime.lock")
LOCKED = re.compile(r"^([a-z0-9][\w.-]*)==([^\s;]+)", re.MULTILINE)


@dataclass(frozen=True, slots=True)
class Soup:
    """Parts that do one thing together: their licences by name, and what is known of them."""

    names: dict[str, str]
    group: str
    purpose: str
    fails: str
    anomalies: str
    asked: str = ""


def reported() -> dict[str, Any]:
    return tomllib.loads((SAFETY / "soup.toml").read_text(encoding="utf-8"))


def parts() -> list[Soup]:
    return [Soup(**one) for one in reported()["part"]]


def locked() -> dict[str, str]:
    """Give every part of the locks, with its version."""
    texts = [(ROOT / "packaging" / lock).read_text(encoding="utf-8") for lock in LOCKS]
    return dict(LOCKED.findall("\n".join(texts)))


def faults() -> Iterator[str]:
    """Say what the lock and the list do not have in common."""
    named = [name for part in parts() for name in part.names]
    development = reported()["development"]["names"]
    both = [*named, *development]
    yield from (f"{name} is there twice" for name in sorted({name for name in both if both.count(name) > 1}))
    yield from (f"{name} is locked, and nothing states why" for name in sorted(locked().keys() - set(both)))
    yield from (f"{name} is not in the lock" for name in sorted(set(both) - locked().keys()))


def page() -> str:
    versions = locked()
    listed = parts()
    lines = [
        "# Parts that others made",
        "",
        "Made by `python packaging/soup.py` from `soup.toml` and the lock, which are what to change.",
        "",
        *reported()["introduction"].strip().splitlines(),
        "",
        f"{sum(len(part.names) for part in listed)} of {len(versions)} locked parts run with the program; the others "
        "with its tests and checks only.",
    ]
    for group in dict.fromkeys(part.group for part in listed):
        lines += ["", f"## {group}"]
        for part in (one for one in listed if one.group == group):
            asked = f" Only with the extra {part.asked}." if part.asked else ""
            lines += ["", f"- **For**: {part.purpose}.{asked}", f"- **If it is wrong**: {part.fails}."]
            lines += [f"- **Anomalies**: {part.anomalies}.", "", "| part | version | licence |", "|---|---|---|"]
            lines += [f"| {name} | {versions[name]} | {licence} |" for name, licence in part.names.items()]
    return "\n".join([*lines, ""])


if __name__ == "__main__":
    if wrong := list(faults()):
        sys.exit("\n".join(wrong))
    (SAFETY / "soup.md").write_text(page(), encoding="utf-8", newline="\n")
    print("packaging/safety/soup.md")
