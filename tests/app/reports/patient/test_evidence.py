"""What the page of the method prints of measurement errors is what judges."""

import re

from app.reports.patient.evidence import error_table
from core.verdicts.measurement_error import SENTENCE_FACTORS
from core.verdicts.sigmas import ComparisonKind


def test_how_many_errors_a_change_needs_on_page_one_is_printed_as_it_is_judged() -> None:
    stated = str(error_table()[-1])
    printed = [float(found) for found in re.findall(r"\d\.\d+", stated)]
    kinds = (ComparisonKind.VISITS, ComparisonKind.STRAPPINGS, ComparisonKind.ATTACHED)
    assert printed == [SENTENCE_FACTORS[kind] for kind in kinds]
