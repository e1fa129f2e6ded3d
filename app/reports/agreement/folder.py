"""An agreement as files: tables, curves, Figures 8 and 9, and the PDF that holds them all."""

from datetime import datetime
from pathlib import Path

from app.reports.agreement.document import agreement_report
from app.reports.agreement.pictures import pictures_of
from app.reports.agreement.study import AgreementStudy, as_shown
from app.reports.agreement.tables import write_study
from core.session import Session

REPORT = "agreement.pdf"


def write_agreement(
    study: AgreementStudy, session: Session, folder: Path, made_at: datetime | None, version: str
) -> None:
    """Write all files into the existing `folder`; without a time of making there is no PDF; raises OSError."""
    write_study(study, folder)
    shown = as_shown(study, session.recordings)
    pictures = pictures_of(shown, session.patient)
    for name, drawn in pictures.items():
        (folder / f"{name}.svg").write_text(drawn.svg, encoding="utf-8")
    if made_at is not None:
        (folder / REPORT).write_bytes(agreement_report(shown, session, pictures, made_at, version))
