"""Findings: what was noticed about the data, as data; `app.wording.findings` turns them into sentences."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum


class Severity(StrEnum):
    """How much a finding matters to whoever reads results."""

    INFO = "info"
    WARNING = "warning"
    GRAVE = "grave"


@dataclass(frozen=True, slots=True)
class Finding:
    """One thing worth telling.

    `key` names the sentence in `app.wording`, `where` the recording, site or joint (several separated by ", "),
    `numbers` what the sentence needs: figures with their unit in the key, and names such as an unknown column.
    """

    key: str
    severity: Severity
    where: str
    numbers: Mapping[str, float | int | str] = field(default_factory=dict)
