"""Small tables of text as CSV files, safe to open in a spreadsheet, and small files of JSON."""

import csv
import json
import math
from collections.abc import Iterable, Sequence
from decimal import Decimal
from pathlib import Path
from typing import Any

MOST_BYTES = 50_000_000  # of a file that may be one of ours, which take a few hundred kilobytes
FORMULA = ("=", "+", "-", "@")


def write_table(header: Sequence[str], rows: Iterable[Sequence[str]], path: Path) -> None:
    """Write rows of text cells as a small CSV table; raises OSError."""
    with path.open("w", encoding="utf-8", errors="backslashreplace", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows([header, *rows])


def figure_cell(value: float) -> str:
    """A figure as a table of CSV has it; empty where there is none."""
    return f"{value:.5f}" if math.isfinite(value) else ""


def finite(value: float | None) -> float | None:
    """A figure as JSON can hold it; None for what is not known or has no bound."""
    return float(value) if value is not None and math.isfinite(value) else None


def read_json(path: Path, form: str) -> dict[str, Any] | None:
    """Read a file of ours that states its `format`; None where there is none, or one of another program."""
    try:
        content = json.loads(path.read_text(encoding="utf-8")) if path.stat().st_size <= MOST_BYTES else None
    except (OSError, ValueError, RecursionError):  # ValueError: no JSON, or not even UTF-8
        return None
    return content if isinstance(content, dict) and content.get("format") == form else None


def is_free(out: Path) -> bool:
    """Whether nothing is at a place, or an empty folder."""
    return not out.exists() or (out.is_dir() and not any(out.iterdir()))


def typed_cell(text: str) -> str:
    """What somebody typed, as a cell that no spreadsheet works out: where it begins as a formula, ' goes before it."""
    return f"'{text}" if text.lstrip().startswith(FORMULA) or text.startswith(("\t", "\r", "\n")) else text


def csv_cell(value: object) -> str:
    """Give one value as a cell: empty where there is none, numbers with all their digits, no text as a formula."""
    match value:
        case None:
            return ""
        case bool():
            return "true" if value else "false"
        case float():
            return "" if math.isnan(value) else repr(value)
        case int() | Decimal():
            return str(value)
    return typed_cell(str(value))
