"""`gaitwright agree`: what a session and an optical system differ by, in the shape of Table 1."""

import argparse
from datetime import datetime
from pathlib import Path

from app.cli.places import read_place
from app.exports.result_folder import written_beside
from app.importing.untrusted_files import read_foreign_reference
from app.reports.agreement.folder import write_agreement
from app.reports.agreement.printed import printed
from app.reports.agreement.study import study_of
from app.reports.agreement.tables import FORMAT, SUMMARY
from app.system.logs import version_of
from app.system.progress import Report
from app.system.tables import is_free, read_json
from core.analysis import analyse
from devices.files.refusal import FileRefusedError, one_line


def run(args: argparse.Namespace, report: Report) -> list[str]:
    """Write the agreement and give the lines for the terminal.

    Raises
    ------
    FileRefusedError
        The session or a reference cannot be read, nothing can be compared, or something else is at OUT.
    OSError
        The agreement cannot be written.
    """
    _check_place(args.out)
    files = []
    for path in args.reference:

        def waiting(path: Path = path) -> None:
            report(0.0, str(path))

        files.append((path.name, read_foreign_reference(path, waiting)))
    session = read_place(args, args.session, report)
    study = study_of(analyse(session, progress=report), files)
    report(1.0, "writing")
    with written_beside(args.out) as folder:
        made_at = None if args.no_report else datetime.now().astimezone()
        write_agreement(study, session, folder, made_at, version_of("gaitwright"))
        report(1.0, "writing")
    walks = len(study.walks)
    count = f"{walks} {'recording' if walks == 1 else 'recordings'} compared"
    return [
        *printed(study, session.patient),
        "",
        f"{one_line(str(args.out))}: {count}. Research use. Not a medical device.",
    ]


def _check_place(out: Path) -> None:
    """See whether an agreement may stand at `out`: nothing is there, or only an agreement.

    Raises
    ------
    FileRefusedError
        Something else is there.
    """
    if is_free(out):
        return
    if read_json(out / SUMMARY, FORMAT) is None or any(out.rglob("session.toml")):
        raise FileRefusedError(
            str(out), "this already exists and is not a comparison with a reference", "Choose another --out"
        )
