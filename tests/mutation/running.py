"""Find the tests of the default run that could notice a mutant, and whether one does."""

import ast
import importlib
import json
import os
import shutil
import signal
import subprocess
import sys
import time
from collections import defaultdict
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from enum import StrEnum
from pathlib import Path
from typing import NoReturn, Protocol

import pytest

from tests.mutation.mutants import Mutant

PACKAGES = (
    *("app/exports", "devices", "core/gait", "core/calibration"),
    *("core/verdicts", "app/summary/differences.py"),  # where a silent fault would be a wrong sentence
)
TEST_FOLDERS = (
    *("tests/core", "tests/devices", "tests/app/exports", "tests/app/reports", "tests/app/summary"),
    *("tests/app/test_exported_doubt.py", "tests/app/test_compare_and_export.py"),
)
LEFT_BEHIND = (".git", ".venv", "build", "__pycache__", ".hypothesis", "*.egg-info", ".*_cache")
MOST_SECONDS = 30.0  # of tests for one mutant; the mirror's and the shortest come first
MOST_TESTS = 400
PRELOADED = (  # so that no mutant waits for them; the project itself is imported again each time
    *(
        "numpy",
        "scipy.signal",
        "scipy.optimize",
        "scipy.interpolate",
        "scipy.spatial.transform",
        "vqf",
        "PySide6.QtWidgets",
    ),
    *("ezc3d", "openpyxl", "fhir.resources.R4B.bundle", "pyarrow.parquet", "sqlalchemy.orm", "alembic.command"),
    *("sqlcipher3", "cryptography.hazmat.primitives.ciphers.aead", "serial", "typst", "rerun"),
)
START_S, SLOWER = 20.0, 4.0  # a mutant may take this and so many times what its tests took
PART = ("--snapshot-warn-unused",)  # of the tests: tables of the others are no failure


class Fate(StrEnum):
    KILLED = "killed"
    SURVIVED = "survived"
    TIMEOUT = "timeout"
    UNCOVERED = "no coverage"


class SourceChange(Protocol):
    """A file, and what becomes of its text: a mutant, or a control that is broken on purpose."""

    @property
    def file(self) -> str: ...

    def applied(self, source: str) -> str: ...


@dataclass(frozen=True, slots=True)
class Outcome:
    fate: Fate
    seconds: float
    tests: int
    killer: str = ""


@dataclass(slots=True)
class Coverage:
    """What `tests.mutation.covering` wrote: how long each test that passes takes, and which of them run a line."""

    seconds: dict[str, float]
    lines: dict[str, dict[int, set[str]]]
    _names: dict[str, dict[str, set[str]]] = field(default_factory=dict)

    @classmethod
    def read(cls, path: Path) -> "Coverage":
        reported = json.loads(path.read_text(encoding="utf-8"))
        passed = {test for test, one in reported["tests"].items() if one["passed"]}
        users: dict[str, set[str]] = defaultdict(set)
        for test in passed:
            users[test].add(test)
            for fixture in reported["tests"][test]["fixtures"]:
                users[fixture].add(test)
        of_context = [users.get(context, set()) for context in reported["contexts"]]
        lines = {
            file: {int(line): set().union(*(of_context[k] for k in contexts)) for line, contexts in some.items()}
            for file, some in reported["lines"].items()
        }
        return cls({test: float(reported["tests"][test]["seconds"]) for test in passed}, lines)

    def of_mutant(self, root: Path, mutant: Mutant) -> set[str]:
        """Tests that run the line; of a line that runs at import, those that run what its names are used in."""
        tree = ast.parse((root / mutant.file).read_text(encoding="utf-8"))
        here = self.lines.get(mutant.file, {})
        functions = [n for n in ast.walk(tree) if isinstance(n, ast.FunctionDef | ast.AsyncFunctionDef)]
        inner = [f for f in functions if f.lineno <= mutant.line <= (f.end_lineno or 0)]
        if inner:
            function = max(inner, key=lambda f: f.lineno)
            begins = function.body[0].lineno
            if mutant.line < begins:  # an argument's default
                return self._between(here, begins, function.end_lineno or begins)
            statement = _innermost(function, mutant.line)
            return self._between(here, statement.lineno, max(mutant.end_line, statement.lineno))
        names = _names_bound_at(tree, mutant.line)
        tests: set[str] = set().union(*(self._of_name(root, name).get(mutant.file, set()) for name in names))
        tests |= set().union(*(some for name in names for some in self._of_name(root, name).values()))
        return tests or set().union(*here.values())

    @staticmethod
    def _between(lines: dict[int, set[str]], first: int, last: int) -> set[str]:
        return set().union(*(tests for line, tests in lines.items() if first <= line <= last))

    def _of_name(self, root: Path, name: str) -> dict[str, set[str]]:
        """Tests that run a line with this name, file by file."""
        if name not in self._names:
            found: dict[str, set[str]] = {}
            for file, lines in self.lines.items():
                source = (root / file).read_text(encoding="utf-8") if (root / file).exists() else ""
                if name in source:
                    at = {line for line, text in enumerate(source.splitlines(), start=1) if name in text}
                    found[file] = set().union(*(tests for line, tests in lines.items() if line in at))
            self._names[name] = found
        return self._names[name]

    def in_order(self, tests: set[str], file: str) -> list[str]:
        """The tests of the file's own folder first, then the shortest, as far as there is time."""
        folder = f"tests/{file.rpartition('/')[0]}/"
        package = f"tests/{file.partition('/')[0]}/"

        def rank(test: str) -> tuple[int, float]:
            return (0 if test.startswith(folder) else 1 if test.startswith(package) else 2, self.seconds[test])

        some: list[str] = []
        seconds = 0.0
        for test in sorted(tests, key=rank)[:MOST_TESTS]:
            seconds += self.seconds[test]
            if seconds > MOST_SECONDS and some:
                break
            some.append(test)
        return some


def _innermost(function: ast.AST, line: int) -> ast.stmt:
    """The smallest statement around a line; of one that holds others only its head counts."""
    around = [n for n in ast.walk(function) if isinstance(n, ast.stmt) and n.lineno <= line <= (n.end_lineno or 0)]
    return max(around, key=lambda n: (n.lineno, n.col_offset))


def _names_bound_at(tree: ast.Module, line: int) -> set[str]:
    """What a statement of a module or class gives a name to."""
    names: set[str] = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Assign | ast.AnnAssign) and node.lineno <= line <= (node.end_lineno or 0):
            targets = node.targets if isinstance(node, ast.Assign) else [node.target]
            names |= {n.id for target in targets for n in ast.walk(target) if isinstance(n, ast.Name)}
    return names


class Tree:
    """A copy of the project in which one mutant at a time lives, so that the project itself is never touched."""

    def __init__(self, root: Path, place: Path) -> None:
        self._root, self._place = root, place
        shutil.rmtree(place, ignore_errors=True)
        shutil.copytree(root, place, ignore=shutil.ignore_patterns(*LEFT_BEHIND))
        # by content: a mutant may be written within the same second and be as long
        compiling = [sys.executable, "-m", "compileall", "-q", "--invalidation-mode", "checked-hash"]
        subprocess.run([*compiling, "app", "core", "devices", "resources"], cwd=place, check=True)
        inherited = {k: v for k, v in os.environ.items() if k != "GAITWRIGHT_TEST_DATA"}  # the default run has none
        path = os.pathsep.join([str(place), *filter(None, [inherited.get("PYTHONPATH")])])
        own = {"PYTHONPATH": path, "PYTHONDONTWRITEBYTECODE": "1", "CI": "1"}
        self._environment = inherited | own
        os.environ.pop("GAITWRIGHT_TEST_DATA", None)
        os.environ |= {"QT_QPA_PLATFORM": "offscreen", "OPENBLAS_NUM_THREADS": "1"}
        for library in PRELOADED:
            with suppress(ImportError):
                importlib.import_module(library)

    def check(self, tests: Sequence[str]) -> None:
        """See that all tests are there: a name that is not would look like a failure."""
        (self._place / "wanted.txt").write_text("\n".join(tests), encoding="utf-8")
        command = [sys.executable, "-m", "pytest", "--collect-only", "-q", "-p", "no:cacheprovider"]
        command += [*PART, "@wanted.txt"]
        found = subprocess.run(
            command, cwd=self._place, env=self._environment, capture_output=True, text=True, check=False
        )
        if found.returncode:
            raise LookupError(f"some tests are not there any more, run with --cover:\n{found.stdout[-1000:]}")

    def outcome(self, mutant: SourceChange, tests: Sequence[str], expected_s: float) -> Outcome:
        """Let the tests look at the mutant until one fails."""
        if not tests:
            return Outcome(Fate.UNCOVERED, 0.0, 0)
        file = self._place / mutant.file
        source = file.read_text(encoding="utf-8")
        (self._place / "wanted.txt").write_text("\n".join(tests), encoding="utf-8")
        file.write_text(mutant.applied(source), encoding="utf-8")
        began_s = time.monotonic()
        try:
            fate, stated = self._run(START_S + SLOWER * expected_s)
        finally:
            file.write_text(source, encoding="utf-8")
        killers = [line.split(" - ")[0].split(" ", 1)[-1] for line in stated if line.startswith(("FAILED", "ERROR"))]
        return Outcome(fate, time.monotonic() - began_s, len(tests), killers[0] if killers else "")

    def _run(self, most_s: float) -> tuple[Fate, list[str]]:
        reported = self._place / "told.txt"
        child = os.fork()
        if not child:
            self._look(reported)
        until_s = time.monotonic() + most_s
        while True:
            done, status = os.waitpid(child, os.WNOHANG)
            if done:
                is_whole = os.waitstatus_to_exitcode(status) == 0
                stated = reported.read_text(encoding="utf-8", errors="replace").splitlines()
                return (Fate.SURVIVED if is_whole else Fate.KILLED), stated
            if time.monotonic() > until_s:
                os.killpg(child, signal.SIGKILL)
                os.waitpid(child, 0)
                return Fate.TIMEOUT, []
            time.sleep(0.02)

    def _look(self, reported: Path) -> NoReturn:
        """Run the tests in a child process, which has the libraries already and none of the project."""
        code = 1
        try:
            os.setsid()
            into = os.open(reported, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
            os.dup2(into, 1)
            os.dup2(into, 2)
            os.chdir(self._place)
            os.environ.update(self._environment)
            for name in [name for name in sys.modules if name.split(".")[0] == "tests"]:
                del sys.modules[name]
            sys.path[:] = [str(self._place), *(p for p in sys.path if p and Path(p).resolve() != self._root)]
            sys.dont_write_bytecode = True
            code = int(pytest.main(["-x", "-q", "--tb=no", "-p", "no:cacheprovider", *PART, "@wanted.txt"]))
            sys.stdout.flush()
        finally:
            os._exit(code)
