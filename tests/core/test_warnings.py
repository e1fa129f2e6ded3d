"""Each finding of the core has a session in which it occurs."""

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.benchmarks.warning_cases import CASES
from tests.benchmarks.warnings_table import draw, table

CORE = Path(__file__).parents[2] / "core"
OF_SAMPLES = [key for key, case in CASES.items() if case.is_of_samples]
LONGER = [key for key, case in CASES.items() if not case.is_of_samples]


def keys_reported() -> Iterator[str]:
    """Find every text that is before a severity, and each that is named `key` before it is reported."""
    for file in CORE.rglob("*.py"):
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            reported: list[ast.expr] = []
            if isinstance(node, ast.Call | ast.Tuple):
                parts = node.args if isinstance(node, ast.Call) else node.elts
                reported = parts[:1] if len(parts) > 1 and "severity" in ast.unparse(parts[1]).lower() else []
            elif isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "key":
                reported = [node.value]
            looked_up = {id(p.slice) for part in reported for p in ast.walk(part) if isinstance(p, ast.Subscript)}
            for part in reported:
                for text in ast.walk(part):
                    if isinstance(text, ast.Constant) and isinstance(text.value, str) and id(text) not in looked_up:
                        yield text.value


def test_every_finding_of_the_core_has_a_case_and_every_case_a_finding() -> None:
    assert set(keys_reported()) == set(CASES)


@pytest.mark.endurance
@pytest.mark.parametrize("key", OF_SAMPLES)
def test_a_finding_about_samples_comes_where_it_must(key: str) -> None:
    assert key in {found.key for found in CASES[key].findings()}


@pytest.mark.endurance
@pytest.mark.parametrize("key", LONGER)
def test_a_finding_comes_where_it_must(key: str) -> None:
    assert key in {found.key for found in CASES[key].findings()}


def test_a_table_counts_false_alarms_only_where_a_finding_is_not_true() -> None:
    rows: list[dict[str, object]] = [
        {"seed": 1, "true": ["gaps"], "told": [["gaps", "walk 1"], ["clipped", "walk 1"]]},
        {"seed": 2, "true": [], "told": []},
        {"must": "gaps", "is_told": False},
        {"real": "somebody", "told": [["clipped", "walk"]]},
    ]
    lines = {line.split(" | ")[0].strip("| "): line for line in table(rows).splitlines()}
    assert "| comes |" not in lines["gaps"]
    assert "MISSING | 0.0 % (0/1) | 1 | 0/1" in lines["gaps"]
    assert "50.0 % (1/2) | 0 | 1/1 | 1 |" in lines["clipped **"]


def test_drawn_sessions_differ_and_a_seed_draws_the_same() -> None:
    assert draw(5) == draw(5)
    drawn = [draw(seed) for seed in range(20)]
    assert len({d.settings.rate_hz for d in drawn}) > 2
    assert len({d.settings.tissue for d in drawn}) == 3
    assert len({d.true for d in drawn}) > 5
