"""Check that the tests of a control notice when it is broken. Each is broken once, in a copy of the project.

    python -m tests.safety.broken_controls                    # all of them, some twenty minutes
    python -m tests.safety.broken_controls R-GAT R-DIF-05     # those whose id begins so

A requirement names its tests (`packaging/safety/requirements.toml`); that they pass shows that the control is there
only if they fail where it is not. `broken_controls.toml` states how each is taken away. The requirement's tests are run
as they are first, and then with the control broken: one has to fail. Long tests and shared recordings are left out, so
that what is shown holds for every run of the default tests.
"""

import argparse
import sys
import time
import tomllib
from dataclasses import dataclass
from pathlib import Path

from tests.mutation.running import Fate, Tree

ROOT = Path(__file__).parents[2]
PLACE = ROOT / "build" / "broken_controls"
REQUIREMENTS = ROOT / "packaging" / "safety" / "requirements.toml"
CONTROLS = Path(__file__).with_suffix(".toml")
MOST_S = 120.0  # of one requirement's tests


@dataclass(frozen=True, slots=True)
class BrokenControl:
    """How the control of a requirement is taken away: `find`, once in `file`, becomes `becomes`."""

    requirement: str
    what: str
    file: str
    find: str
    becomes: str

    def applied(self, source: str) -> str:
        """The source without the control."""
        if source.count(self.find) != 1:
            raise LookupError(
                f"{self.requirement}, {self.file}: {self.find!r} is there {source.count(self.find)} times"
            )
        return source.replace(self.find, self.becomes)


@dataclass(frozen=True, slots=True)
class Untouched:
    """A file as it is, to see that the tests pass without a change."""

    file: str

    def applied(self, source: str) -> str:
        return source


def controls(required: list[str]) -> list[BrokenControl]:
    """Give the controls whose requirement's id begins with one of `required`; all without any."""
    reported = tomllib.loads(CONTROLS.read_text(encoding="utf-8"))["broken"]
    every = [BrokenControl(**one) for one in reported]
    return [one for one in every if not required or one.requirement.startswith(tuple(required))]


def tests_of_requirements() -> dict[str, list[str]]:
    reported = tomllib.loads(REQUIREMENTS.read_text(encoding="utf-8"))["requirement"]
    return {one["id"]: one["tests"] for one in reported}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("requirements", nargs="*", help="beginnings of ids; all without any")
    required = controls(parser.parse_args().requirements)
    tests, tree = tests_of_requirements(), Tree(ROOT, PLACE)
    unnoticed: list[BrokenControl] = []
    passed: dict[str, bool] = {}
    for number, control in enumerate(required, start=1):
        began_s, looking = time.monotonic(), tests[control.requirement]
        if control.requirement not in passed:
            untouched = tree.outcome(Untouched(control.file), looking, MOST_S)
            passed[control.requirement] = untouched.fate is Fate.SURVIVED
        if not passed[control.requirement]:
            stated, killer = "fails as it is", ""
        else:
            outcome = tree.outcome(control, looking, MOST_S)
            stated, killer = (
                ("noticed" if outcome.fate is Fate.KILLED else f"not noticed ({outcome.fate})"),
                outcome.killer,
            )
        if stated != "noticed":
            unnoticed.append(control)
        reported = f"{number}/{len(required)} {control.requirement} {stated:12} {time.monotonic() - began_s:5.0f} s"
        print(f"{reported}  {control.what}  {killer}", flush=True)
    noticed = len(required) - len(unnoticed)
    print(f"{noticed} of {len(required)} broken controls noticed by the tests of their requirement")
    sys.exit(1 if unnoticed else 0)


if __name__ == "__main__":
    main()
