"""What an import found, kept in `session.toml`, so that every later analysis knows of it.

What reading the folder finds again by itself is not written.
"""

import math
from collections.abc import Sequence

from core.findings import Finding, Severity

FOUND_AGAIN = frozenset(
    {"unknown_key", "unknown_column", "no_sites", "sensor_changed", "infinite_values", "rate_from_orientation"}
)
LARGEST = 1e15
LONGEST = 10_000  # characters
MOST = 10_000


def finding_tables(findings: Sequence[Finding]) -> list[dict[str, object]]:
    """Tables of the findings that reading does not find again."""
    return [
        {"key": one.key, "severity": one.severity.value, "where": one.where, "numbers": dict(one.numbers)}
        for one in findings
        if one.key not in FOUND_AGAIN
    ]


def findings_of_tables(tables: object) -> tuple[Finding, ...] | None:
    """Findings out of a list of tables; None where one of them is none, or the list is no list."""
    if not isinstance(tables, list) or len(tables) > MOST:
        return None
    found = [_finding(table) for table in tables]
    return tuple(one for one in found if one is not None) if None not in found else None


def _finding(table: object) -> Finding | None:
    if not isinstance(table, dict) or not set(table) <= {"key", "severity", "where", "numbers"}:
        return None
    key, where, numbers = table.get("key"), table.get("where"), table.get("numbers", {})
    severity = table.get("severity")
    if not (_is_text(key) and _is_text(where) and isinstance(numbers, dict) and severity in list(Severity)):
        return None
    if not all(_is_text(value) or _is_figure(value) for value in numbers.values()):
        return None
    return Finding(str(key), Severity(str(severity)), str(where), numbers)


def _is_text(value: object) -> bool:
    return isinstance(value, str) and len(value) <= LONGEST


def _is_figure(value: object) -> bool:
    if isinstance(value, bool) or not isinstance(value, int | float):
        return False
    return abs(value) < LARGEST and math.isfinite(value)
