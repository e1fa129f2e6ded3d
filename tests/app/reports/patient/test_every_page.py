"""Tests that every page of a report states its patient, its purpose and that nobody was measured.

Once in the default run.
"""

import io
import re
from dataclasses import replace

import pikepdf
import pypdf
import pytest

from app.reports.patient.document import make_report
from app.summary.request import AnalysedVisit, ReportRequest


@pytest.fixture(scope="module")
def report(demo: ReportRequest) -> bytes:
    """The report of one walk of somebody else than the fixtures' patient."""
    visit = demo.visit
    patient = replace(visit.session.patient, code="P-0815")
    session = replace(visit.session, patient=patient, started="2026-03-04T10:00:00+01:00")
    required = replace(demo, visit=AnalysedVisit(session, visit.analysis))
    return make_report(required)


def test_every_page_names_its_patient_and_the_day(report: bytes) -> None:
    """So that no sheet of a report gets into another patient's file; and what it is for, and that it is simulated."""
    pages = pypdf.PdfReader(io.BytesIO(report)).pages
    assert len(pages) == 4
    for number, page in enumerate(pages, start=1):
        text = re.sub("[\u2066-\u2069]", "", page.extract_text())
        for stated in ("P-0815", "2026", "Research use. Not a medical device.", "SIMULATED DATA, not a person"):
            assert stated in text, (number, stated)


def test_a_report_is_tagged_titled_and_has_its_fonts(report: bytes) -> None:
    with pikepdf.open(io.BytesIO(report)) as pdf:
        assert bool(pdf.Root.MarkInfo.Marked)
        assert str(pdf.Root.Lang) == "en-GB"
        assert "P-0815" in str(pdf.docinfo["/Title"])
        found = [part for part in pdf.objects if isinstance(part, pikepdf.Dictionary) and "/FontName" in part]
        assert len(found) >= 2
        assert all("/FontFile2" in font or "/FontFile3" in font for font in found)
