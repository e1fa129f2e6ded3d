"""Count how many small changes of the code the default run notices. See README.md beside this file."""

import argparse
import hashlib
import json
import subprocess
import sys
import time
import tomllib
from collections import Counter
from collections.abc import Iterable, Mapping
from itertools import zip_longest
from pathlib import Path
from typing import Any

from tests.mutation.mutants import Mutant, all_mutants, chosen
from tests.mutation.running import PACKAGES, TEST_FOLDERS, Coverage, Fate, Outcome, Tree

ROOT = Path(__file__).parents[2]
BUILD = ROOT / "build" / "mutation"
COVERING, RESULTS = BUILD / "covering.json", BUILD / "results.jsonl"
EQUIVALENT = Path(__file__).with_name("equivalent.toml")
SEED = 15
ALIVE = (Fate.SURVIVED, Fate.UNCOVERED)
AGAIN = (*ALIVE, Fate.TIMEOUT)  # on a machine that is busy with other things, too, not every timeout is an endless loop

Results = dict[str, dict[str, Any]]
"""The last result of each mutant, by its name."""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("packages", nargs="*", default=PACKAGES, help=f"of {', '.join(PACKAGES)}")
    parser.add_argument("--count", type=int, default=300, help="mutants in all, as many of each package (300)")
    parser.add_argument("--seed", type=int, default=SEED, help=f"which of them ({SEED})")
    parser.add_argument("--cover", action="store_true", help="first find out again which tests run which lines")
    parser.add_argument("--again", action="store_true", help="try those that survived or took too long once more")
    parser.add_argument("--seconds", type=float, default=float("inf"), help="begin no mutant after so long")
    parser.add_argument("--report", action="store_true", help="run nothing, tell what was found")
    required = parser.parse_args()
    each = -(-required.count // len(required.packages))
    mutants = {package: chosen(ROOT, all_mutants(ROOT, package), each, required.seed) for package in required.packages}
    if not required.report:
        if required.cover or not COVERING.exists():
            cover()
        until_s = time.monotonic() + required.seconds
        in_turn = zip_longest(*mutants.values())  # so that a run that is cut short has tried as many of each
        run([one for several in in_turn for one in several if one], required.again, until_s)
    report(mutants)


def cover() -> None:
    """Run the default tests of the folders once and note which of them run which lines."""
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "-p", "tests.mutation.covering"]
    command.append("--continue-on-collection-errors")
    subprocess.run([*command, f"--covering={COVERING}", *TEST_FOLDERS], cwd=ROOT, check=False)


def run(mutants: Iterable[Mutant], is_again: bool, until_s: float) -> None:
    """Try every mutant whose file has not been tried as it is, and write each result at once."""
    known, equivalent = results(), equivalents()
    coverage, tree = Coverage.read(COVERING), Tree(ROOT, BUILD / "tree")
    tree.check(sorted(coverage.seconds))
    for one in mutants:
        before = known.get(one.name)
        is_known = before is not None and before["source"] == digest(one.file)
        if is_known and not (is_again and before is not None and before["fate"] in AGAIN):
            continue
        if named(one) in equivalent or time.monotonic() > until_s:
            continue
        tests = coverage.in_order(coverage.of_mutant(ROOT, one), one.file)
        outcome = tree.outcome(one, tests, sum(coverage.seconds[test] for test in tests))
        note(one, outcome)
        print(f"{outcome.fate:11} {outcome.seconds:5.1f} s  {one.file}:{one.line}  {one.after[:90]}", flush=True)


def note(one: Mutant, outcome: Outcome) -> None:
    reported = {
        "name": one.name,
        "source": digest(one.file),
        "file": one.file,
        "line": one.line,
        "before": one.before,
        "after": one.after,
        "fate": str(outcome.fate),
        "seconds": round(outcome.seconds, 1),
        "tests": outcome.tests,
        "killer": outcome.killer,
    }
    RESULTS.parent.mkdir(parents=True, exist_ok=True)
    with RESULTS.open("a", encoding="utf-8") as file:
        file.write(json.dumps(reported, ensure_ascii=False) + "\n")


def digest(file: str) -> str:
    return hashlib.sha256((ROOT / file).read_bytes()).hexdigest()[:12]


def results() -> Results:
    if not RESULTS.exists():
        return {}
    reported = (json.loads(line) for line in RESULTS.read_text(encoding="utf-8").splitlines())
    return {one["name"]: one for one in reported}


Change = tuple[str, str, str]
"""File, line as it is, line as it becomes."""


def equivalents() -> dict[Change, str]:
    """Mutants that behave as the code does, and why."""
    reported = tomllib.loads(EQUIVALENT.read_text(encoding="utf-8"))
    return {(one["file"], one["line"], one["becomes"]): one["reason"] for one in reported.get("mutant", [])}


def named(one: Mutant) -> Change:
    return one.file, one.before, one.after


def report(mutants: Mapping[str, list[Mutant]]) -> None:
    """Print a table by packages, then every survivor."""
    known, equivalent = results(), equivalents()
    rows, alive = [], []
    for package, some in mutants.items():
        count: Counter[str] = Counter()
        for one in some:
            if named(one) in equivalent:
                count["equivalent"] += 1
            elif one.name in known:
                count[known[one.name]["fate"]] += 1
                if known[one.name]["fate"] in ALIVE:
                    alive.append(one)
            else:
                count["not tried"] += 1
        rows.append((package, count))
    rows.append(("all", sum((count for _, count in rows), Counter())))
    columns = [*(str(fate) for fate in Fate), "equivalent", "not tried"]
    print(" | ".join(["package", *columns, "noticed"]))
    for package, count in rows:
        noticed = count[Fate.KILLED] + count[Fate.TIMEOUT]
        tried = noticed + count[Fate.SURVIVED] + count[Fate.UNCOVERED]
        share = f"{100.0 * noticed / tried:.0f} %" if tried else "-"
        print(" | ".join([package, *(str(count[name]) for name in columns), share]))
    for one in alive:
        print(f"\n{one.file}:{one.line} ({known[one.name]['fate']})\n  - {one.before}\n  + {one.after}")


if __name__ == "__main__":
    main()
