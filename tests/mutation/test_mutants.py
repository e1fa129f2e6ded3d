"""Tests of mutants: one change each, reported by name, and tried by the tests that run the line."""

import json
from pathlib import Path

from tests.mutation.mutants import chosen, compiles, mutants_of
from tests.mutation.running import Coverage

SOURCE = '''"""A docstring of 3 words."""
from typing import Final

LIMITS: Final[tuple[float, float]] = (1.5, 2.0)
NAMES = {"a": "left", "b": "right"}


def is_within(value: float, offset: float = 0.0) -> bool:
    """Say whether 1 is 1."""
    shifted = value - offset
    if shifted < LIMITS[0] and not shifted > 9:
        raise ValueError(f"{shifted} is {1 + 1} too small")
    return min(shifted, LIMITS[1]) == pow(value, offset)
'''


def test_every_kind_of_change_is_made_once() -> None:
    after = [one.after for one in mutants_of(SOURCE, "one.py")]
    assert len(set(after)) == len(after)
    for expected in (
        "LIMITS: Final[tuple[float, float]] = (2.0, 1.5)",
        "LIMITS: Final[tuple[float, float]] = (3.0, 2.0)",
        "NAMES = {'a': 'right', 'b': 'left'}",
        'NAMES = {"a": \'leftl\', "b": "right"}',
        "def is_within(value: float, offset: float = 1.0) -> bool:",
        "shifted = (value + offset)",
        "if shifted <= LIMITS[0] and not shifted > 9:",
        "if shifted < LIMITS[0] and (shifted > 9):",
        "if ((shifted < LIMITS[0]) or (not shifted > 9)):",
        "if shifted < LIMITS[0] and not shifted > 10:",
        "return None",
        "return min(shifted, LIMITS[1]) != pow(value, offset)",
        "return min(shifted, LIMITS[1]) == pow(offset, value)",
    ):
        assert expected in after, expected
    assert not any("LIMITS[1], shifted" in one for one in after)  # which of two is less does not depend on their order


def test_docstrings_annotations_and_the_words_of_errors_are_left_alone() -> None:
    lines = SOURCE.splitlines()
    left_alone = {k for k, line in enumerate(lines, start=1) if '"""' in line or "raise" in line or "import" in line}
    found = mutants_of(SOURCE, "one.py")
    assert left_alone.isdisjoint(one.line for one in found)
    assert all("Final[tuple[float, float]]" in one.after for one in found if one.line == 4)


def test_a_mutant_changes_its_line_only_and_is_python() -> None:
    for one in mutants_of(SOURCE, "one.py"):
        assert compiles(one.applied(SOURCE)), one.after
        pairs = zip(SOURCE.splitlines(), one.applied(SOURCE).splitlines(), strict=True)
        assert [k for k, (was, becomes) in enumerate(pairs, start=1) if was != becomes] == [one.line]


def test_columns_are_counted_in_bytes() -> None:
    (one,) = (m for m in mutants_of('x = {"°": 1, "é": "ü"}\n', "one.py") if m.after.endswith("\"é\": 'üü'}"))
    assert one.applied('x = {"°": 1, "é": "ü"}\n') == 'x = {"°": 1, "é": \'üü\'}\n'


def test_a_line_that_moves_keeps_its_mutants_and_their_choice(tmp_path: Path) -> None:
    moved = SOURCE.replace("LIMITS: Final", "\n\nMORE = 1.5\nLIMITS: Final")
    names = {one.name for one in mutants_of(SOURCE, "one.py")}
    assert names < {one.name for one in mutants_of(moved, "one.py")}
    some = []
    for text in (SOURCE, moved):
        (tmp_path / "one.py").write_text(text)
        some.append({one.name for one in chosen(tmp_path, mutants_of(text, "one.py"), 10, 1)})
    assert len(some[0]) == len(some[1]) == 10
    assert len(some[0] - some[1]) <= 3


def test_a_mutant_is_tried_by_the_tests_that_run_its_line(tmp_path: Path) -> None:
    """Lines of a fixture count for its tests, those of a table for the tests of the lines where its name is."""
    (tmp_path / "core").mkdir()
    (tmp_path / "core" / "one.py").write_text(SOURCE)
    names = ["tests/core/test_one.py::a", "tests/core/test_one.py::b", "tests/app/test_far.py::c", "fixture  made"]
    reported = {
        "tests": {
            names[0]: {"fixtures": [], "seconds": 2.0, "passed": True},
            names[1]: {"fixtures": ["fixture  made"], "seconds": 0.5, "passed": True},
            names[2]: {"fixtures": [], "seconds": 0.1, "passed": True},
            "tests/core/test_one.py::fails": {"fixtures": [], "seconds": 0.1, "passed": False},
        },
        "contexts": [*names, "tests/core/test_one.py::fails"],
        "lines": {"core/one.py": {"10": [0, 2, 3, 4], "11": [3, 4], "13": [0]}},
    }
    (tmp_path / "covering.json").write_text(json.dumps(reported))
    coverage = Coverage.read(tmp_path / "covering.json")
    tests = {one.after: coverage.of_mutant(tmp_path, one) for one in mutants_of(SOURCE, "core/one.py")}
    assert tests["shifted = (value + offset)"] == set(names[:3])
    assert tests["if shifted < LIMITS[0] and not shifted > 10:"] == {names[1]}
    assert tests["LIMITS: Final[tuple[float, float]] = (2.0, 1.5)"] == {names[0], names[1]}
    assert tests["def is_within(value: float, offset: float = 1.0) -> bool:"] == set(names[:3])
    assert coverage.in_order(set(names[:3]), "core/one.py") == [names[1], names[0], names[2]]
