"""Plugin of pytest that reports which tests run which lines, test by test and fixture by fixture.

    python -m pytest -p tests.mutation.covering --covering=build/mutation/covering.json tests/core

Lines that a fixture runs belong to every test that uses the fixture, whichever of them came first.
"""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import coverage
import pytest

MEASURED = ("app", "core", "devices")


class Covering:
    """Switches the context of the measurement with every fixture and test, and writes what was found at the end."""

    def __init__(self, root: Path, into: Path) -> None:
        self._root, self._into = root, into
        self._coverage = coverage.Coverage(
            data_file=None, config_file=False, include=[str(root / name / "*") for name in MEASURED]
        )
        self._coverage.start()
        self._contexts: list[str] = []
        self._tests: dict[str, dict[str, Any]] = {}

    def _enter(self, context: str) -> None:
        self._contexts.append(context)
        self._coverage.switch_context(context)

    def _leave(self) -> None:
        self._contexts.pop()
        self._coverage.switch_context(self._contexts[-1] if self._contexts else "")

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Iterator[None]:
        definitions = getattr(getattr(item, "_fixtureinfo", None), "name2fixturedefs", {})
        fixtures = sorted({_named(one) for several in definitions.values() for one in several})
        self._tests[item.nodeid] = {"fixtures": fixtures, "seconds": 0.0, "passed": True}
        self._enter(item.nodeid)
        yield
        self._leave()

    @pytest.hookimpl(wrapper=True)
    def pytest_fixture_setup(self, fixturedef: "pytest.FixtureDef[Any]") -> Iterator[None]:
        self._enter(_named(fixturedef))
        try:
            return (yield)
        finally:
            self._leave()

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        test = self._tests[report.nodeid]
        test["seconds"] += report.duration
        test["passed"] &= report.passed

    def pytest_sessionfinish(self) -> None:
        self._coverage.stop()
        data = self._coverage.get_data()
        contexts: dict[str, int] = {}
        lines: dict[str, dict[int, list[int]]] = {}
        for file in sorted(data.measured_files()):
            of_file = data.contexts_by_lineno(file)
            reported = {
                line: sorted(contexts.setdefault(name, len(contexts)) for name in names if name)
                for line, names in of_file.items()
            }
            lines[Path(file).relative_to(self._root).as_posix()] = {
                line: some for line, some in reported.items() if some
            }
        self._into.parent.mkdir(parents=True, exist_ok=True)
        found = {"tests": self._tests, "contexts": list(contexts), "lines": lines}
        self._into.write_text(json.dumps(found), encoding="utf-8")


def _named(fixture: "pytest.FixtureDef[Any]") -> str:
    return f"fixture {fixture.baseid} {fixture.argname}"


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--covering", help="write which tests run which lines into this file")


def pytest_configure(config: pytest.Config) -> None:
    if into := config.getoption("--covering"):
        config.pluginmanager.register(Covering(config.rootpath, Path(into).absolute()))
