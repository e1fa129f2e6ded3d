"""CSV files as another program reads them."""

import csv
from pathlib import Path


def csv_rows(path: Path, separator: str = ",", encoding: str = "utf-8") -> list[dict[str, str]]:
    """The rows by their heading."""
    with path.open(newline="", encoding=encoding) as file:
        return list(csv.DictReader(file, delimiter=separator))
