"""Compare what the window states of patients, sessions and recordings with what its library holds.

The library is read by plain SQL in a connection of its own, beside the program that has it open: what a page or its
model got wrong is not got wrong here again.
"""

import re
from collections import Counter
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from typing import TYPE_CHECKING, Any

import sqlcipher3.dbapi2 as sqlite

from app.storage.data_key import KeyMaterial

if TYPE_CHECKING:
    from app.home.home import Home
    from app.main_window import MainWindow
    from app.widgets.banner import Banner
    from app.wizard.visit import Visit
    from app.wizard.wizard import Wizard

READ_BACK = "('closed', 'recovered')"
KEPT = re.compile(r"(\d+) included")
STOOD = re.compile("([\\d.]+) s, reference set")
WORN = re.compile(r"(\d) of 6 assigned")
SAVED_AS = re.compile(r"Saved as (.+)\.$")
RECOVERED_ONE = re.compile(r"\d+:\d\d of (.+) was recovered\.")
RECOVERED_MANY = re.compile(r"(\d+) recordings, .+ in total, were recovered\.")
LENGTH = re.compile(r"^(?:.* · )?(\d+):(\d\d)$")
PATIENTS = """
    SELECT p.code, COUNT(s.id) FROM patients p LEFT JOIN sessions s ON s.patient_id = p.id AND s.deleted_at IS NULL
    WHERE p.deleted_at IS NULL AND p.merged_into_id IS NULL GROUP BY p.id"""
SESSIONS = """
    SELECT s.id, s.is_simulated, COUNT(r.id) FROM sessions s LEFT JOIN recordings r ON r.session_id = s.id
    WHERE s.patient_id = ? AND s.deleted_at IS NULL GROUP BY s.id"""
WALKS = f"""
    SELECT name, condition, is_kept, is_decided, judged_by, state FROM recordings
    WHERE session_id = ? AND kind = 'walking' AND state IN {READ_BACK} ORDER BY number"""
PATIENT = """
    SELECT p.code, p.birth_year, p.device FROM patients p JOIN sessions s ON s.patient_id = p.id WHERE s.id = ?"""
PATIENT_FIELDS = ("code", "birth_year", "sex", "height_m", "mass_kg", "device", "aids")
ONE_PATIENT = f"SELECT {', '.join(PATIENT_FIELDS)} FROM patients WHERE id = ?"
CONDITIONS = "SELECT DISTINCT condition FROM recordings WHERE session_id = ? AND condition <> ''"
STANDING = f"""
    SELECT j.file FROM recordings r JOIN journals j ON j.recording_id = r.id
    WHERE r.session_id = ? AND r.kind = 'standing' AND r.is_kept = 1 AND r.state IN {READ_BACK}"""
LEAST_JOURNAL = 4096  # bytes; three seconds of six sensors are a hundred times as many


class HeldLibrary:
    """A library's folder, read beside whoever has it open. `data_key` None: the demonstration's."""

    def __init__(self, folder: Path, data_key: KeyMaterial | None) -> None:
        self.folder, self._data_key = folder, data_key

    def ask(self, statement: str, *values: object) -> list[tuple[Any, ...]]:
        with closing(sqlite.connect(f"{(self.folder / 'library.db').as_uri()}?mode=ro", uri=True)) as connection:
            connection.execute("PRAGMA cipher_log_level = NONE")
            if self._data_key is not None:
                connection.execute(f"PRAGMA key = \"x'{self._data_key.hex()}'\"")
            return list(connection.execute(statement, values).fetchall())


def contradictions(window: "MainWindow", held: HeldLibrary) -> list[str]:
    """What the screen in sight states otherwise than the library; what is still on its way may be among it."""
    screen = window.screens.currentWidget()
    if window.home is not None and screen is window.home:
        return [*_of_home(window.home, held), *_of_banner(window.home.banner, held)]
    wizard = window.wizard
    if wizard is not None and screen is wizard and wizard.visit is not None and wizard.visit.session is not None:
        visit = wizard.visit
        if not held.ask("SELECT 1 FROM sessions WHERE id = ?", wizard.visit.session.id.hex):
            return ["the session in sight is not held"]
        stated = [*_of_frame(wizard, visit, held), *_of_rail(wizard, visit, held), *_of_page(wizard, visit, held)]
        return [*stated, *_of_banner(wizard.shell.banner, held)]
    return []


# home


def _of_home(home: "Home", held: HeldLibrary) -> Iterator[str]:
    from app.home.settings.settings_page import SettingsPage
    from app.widgets.line_list import PatientLine, SessionLine

    page = home.page
    if isinstance(home.current, SettingsPage):
        yield from _of_settings(home.current, held)
    if home.current is not page or page._patients is None:
        return  # of what is still to be read nothing is stated
    if not page.search.text():
        lines = [line for line in page.patients.lines if isinstance(line, PatientLine)]
        stated = Counter((line.code, _number(line.sessions)) for line in lines)
        are = Counter((str(code), int(count)) for code, count in held.ask(PATIENTS))
        if stated != are:
            yield f"home lists patients {_only(stated, are)}, held are {_only(are, stated)}"
    if page.patient_id is None:
        return
    reported = held.ask("SELECT code FROM patients WHERE id = ?", page.patient_id.hex)
    if not reported or page.panel.code.text() != reported[0][0]:
        yield f"home shows the sessions of {page.panel.code.text()!r}, held is {reported}"
    shown = [line for line in page.sessions.lines if isinstance(line, SessionLine)]
    in_recordings = [line for line in shown if "recording" in line.amount]  # the others count strides
    uncounted = {line.id.hex for line in shown} - {line.id.hex for line in in_recordings}
    stated_of = Counter((line.id.hex, _number(line.amount)) for line in in_recordings)
    stated_of.update((identity, 0) for identity in uncounted)
    rows = held.ask(SESSIONS, page.patient_id.hex)
    held_of = Counter((str(identity), 0 if str(identity) in uncounted else int(count)) for identity, _, count in rows)
    if stated_of != held_of:
        yield f"home lists sessions {_only(stated_of, held_of)}, held are {_only(held_of, stated_of)}"
    simulated = {identity for identity, is_simulated, _ in rows if is_simulated}
    for line in shown:
        conditions = {str(one) for (one,) in held.ask(CONDITIONS, line.id.hex)}
        if set(filter(None, line.conditions.split("; "))) != {part for one in conditions for part in one.split("; ")}:
            yield f"home says conditions {line.conditions!r}, held are {sorted(conditions)}"
        if line.state == "simulated" and line.id.hex not in simulated:
            yield f"home calls session {line.when} simulated, it is not held as such"


def _of_settings(page: Any, held: HeldLibrary) -> Iterator[str]:
    shown = page.deleted_rows.count()
    (count,) = held.ask(
        "SELECT (SELECT COUNT(*) FROM patients WHERE deleted_at IS NOT NULL AND merged_into_id IS NULL) + "
        "(SELECT COUNT(*) FROM sessions s JOIN patients p ON p.id = s.patient_id "
        "WHERE s.deleted_at IS NOT NULL AND p.deleted_at IS NULL)"
    )[0]
    if page.deleted_card.isVisible() and shown != count:
        yield f"settings list {shown} deleted, held are {count}"
    operators = held.ask("SELECT COUNT(*) FROM operators")[0][0]
    if page.operators.isVisible() and page.operators.rows.count() != operators:
        yield f"settings list {page.operators.rows.count()} operators, held are {operators}"
    stated = re.match(r"Backup folder: (.+)\.$", page.backup_folder.text())
    kept = held.ask("SELECT value FROM settings WHERE name = 'backup_folder'")
    if page.backup_folder.isVisible() and stated is not None and (not kept or stated[1] not in str(kept[0][0])):
        yield f"settings say {stated[0]!r}, held is {kept}"


# a session


def _of_frame(wizard: "Wizard", visit: "Visit", held: HeldLibrary) -> Iterator[str]:
    from app.wizard.step import StepId

    assert visit.session is not None
    ((code, birth_year, device),) = held.ask(PATIENT, visit.session.id.hex)
    header = wizard.shell.header
    if wizard.step_id is not StepId.PATIENT:  # where it is being typed
        if header.code.text() != code:
            yield f"the header names {header.code.text()!r}, the session is held as {code!r}'s"
        facts = header.facts.text()
        if birth_year and str(birth_year) not in facts:
            yield f"the header says {facts!r}, held is the birth year {birth_year}"
        if device and device not in facts:
            yield f"the header says {facts!r}, held is the device {device!r}"
    is_simulated = held.ask("SELECT is_simulated FROM sessions WHERE id = ?", visit.session.id.hex)[0][0]
    if is_simulated and header.simulated.isHidden():
        yield "the session is held as simulated, the header does not say so"


def _of_rail(wizard: "Wizard", visit: "Visit", held: HeldLibrary) -> Iterator[str]:
    assert visit.session is not None
    session = visit.session.id.hex
    notes = [row.note for row in wizard.shell.rail.rows]
    walks = held.ask(WALKS, session)
    kept = sum(bool(row[2] and _is_answered(row)) for row in walks)
    is_recording = visit.recordings.is_recording or visit.recordings.is_stopping
    for place in (4, 5):
        if (stated := KEPT.search(notes[place])) is not None and int(stated[1]) != kept and not is_recording:
            yield f"the rail says {notes[place]!r} at step {place + 1}, held are {kept} walks kept"
    if "include or exclude" in notes[4] and all(_is_answered(row) for row in walks):
        yield "the rail asks whether a walk is kept, held is none that is not decided"
    if notes[5] == "" and kept and not is_recording:
        yield f"the rail says of no result, held are {kept} walks kept"
    cannot_stand = bool(held.ask("SELECT cannot_stand FROM sessions WHERE id = ?", session)[0][0])
    if ("skipped" in notes[2]) != cannot_stand:
        yield f"the rail says {notes[2]!r} of standing, held is cannot_stand {cannot_stand}"
    if STOOD.search(notes[2]) is not None:
        files = [held.folder / "recordings" / file for (file,) in held.ask(STANDING, session)]
        if not any(file.exists() and file.stat().st_size > LEAST_JOURNAL for file in files):
            yield f"the rail says {notes[2]!r}, held is no kept standing with samples"


def _is_answered(row: tuple[Any, ...]) -> bool:
    _, _, is_kept, is_decided, judged_by, state = row
    return bool(is_decided) and not (state == "recovered" and not judged_by and is_kept)


def _of_page(wizard: "Wizard", visit: "Visit", held: HeldLibrary) -> Iterator[str]:
    current = type(wizard.current).__name__
    if current == "PatientStep":
        yield from _of_patient(wizard, visit, held)
    elif current == "WalkingStep":
        yield from _of_walks(wizard, visit, held)
    elif current == "ResultsStep":
        yield from _of_results(wizard, visit, held)
    elif current == "ReportStep":
        yield from _of_report(wizard, visit, held)


def _of_patient(wizard: "Wizard", visit: "Visit", held: HeldLibrary) -> Iterator[str]:
    from app.wizard.patient.page import PatientPage

    page, stored = wizard.current.page if wizard.current is not None else None, visit.patient.stored
    if not isinstance(page, PatientPage) or page._saved.text() != "saved" or stored is None:
        return
    (row,) = held.ask(ONE_PATIENT, stored.id.hex) or [(None,) * len(PATIENT_FIELDS)]
    for name, value in zip(PATIENT_FIELDS, row, strict=True):
        typed = getattr(page.draft.patient, name)
        typed = typed.strip() if isinstance(typed, str) else typed
        if (typed or "") != (value or ""):
            yield f"the page says saved with {name} {typed!r}, held is {value!r}"


def _of_walks(wizard: "Wizard", visit: "Visit", held: HeldLibrary) -> Iterator[str]:
    from app.wizard.walking.page import WalkingPage

    page = wizard.current.page if wizard.current is not None else None
    if not isinstance(page, WalkingPage) or visit.session is None:
        return
    words = {"kept": True, "discarded": False}
    shown = [row for row in page.rows if row.state != "recording"]
    walks = held.ask(WALKS, visit.session.id.hex)
    stated = [row.label for row in shown]
    are = [row[1] or row[0] for row in walks]
    if stated != are:
        yield f"the list of walks says {stated}, held are {are}"
        return
    for row, walk in zip(shown, walks, strict=True):
        if row.state in words and words[row.state] != bool(walk[2]):
            yield f"the list calls {row.label!r} {row.state}, held is is_kept {walk[2]}"
        if (row.state in ("asking", "recovered")) == _is_answered(walk):
            yield f"the list calls {row.label!r} {row.state}, held is decided {walk[3]}, judged by {walk[4]!r}"


def _of_results(wizard: "Wizard", visit: "Visit", held: HeldLibrary) -> Iterator[str]:
    frame: Any = wizard.current.page if wizard.current is not None else None
    if frame is None or visit.session is None or visit.evaluation.is_busy:
        return
    walks = held.ask(WALKS, visit.session.id.hex)
    if frame.currentWidget() is frame.sentence and "No walk is included yet" in frame.sentence._what.text():
        if any(row[2] for row in walks):
            yield f"the results say that no walk is kept, held are {[row[0] for row in walks if row[2]]}"
        return
    if type(frame.currentWidget()).__name__ != "ResultPage":
        return
    choice = frame.currentWidget().recordings
    stated = [choice.itemText(k) for k in range(choice.count())]
    for name, condition, is_kept, *_ in walks:
        if is_kept and not any(_calls(one, name, condition) for one in stated):
            yield f"the results offer {stated!r}, held is the kept {name!r} ({condition!r}), too"


def _of_report(wizard: "Wizard", visit: "Visit", held: HeldLibrary) -> Iterator[str]:
    note = wizard.shell.bar.state.note
    step: Any = wizard.current
    if (stated := SAVED_AS.search(note)) is not None:
        written = step.written
        if written.name != stated[1] or not (written.is_file() or any(written.glob("*.pdf"))):
            yield f"the bar says {stated[0]!r}, there is no report"
    if visit.session is not None:
        rows = held.ask("SELECT comment FROM sessions WHERE id = ?", visit.session.id.hex)
        if rows and rows[0][0] != step.comment:
            yield f"the report shows the comment {step.comment!r}, held is {rows[0][0]!r}"


def _of_banner(banner: "Banner", held: HeldLibrary) -> Iterator[str]:
    """What is claimed of recordings that were recovered, or are safe; a banner that is hidden claims nothing.

    What was recovered wholly is held as closed.
    """
    if banner.isHidden():
        return
    text = banner.text
    one = RECOVERED_ONE.search(text)
    rows = held.ask(f"SELECT name, condition FROM recordings WHERE state IN {READ_BACK}") if one else []
    if one and not any(_calls(one[1], name, condition) for name, condition in rows):
        yield f"the banner says {text!r}, held is no recovered {one[1]!r}"
    many = RECOVERED_MANY.search(text)
    if many and held.ask(f"SELECT COUNT(*) FROM recordings WHERE state IN {READ_BACK}")[0][0] < int(many[1]):
        yield f"the banner says {text!r}, held are fewer"
    if "safe on the disk" in text and not any((held.folder / "recordings").glob("*.journal")):
        yield f"the banner says {text!r}, there is no journal"


def _calls(stated: str, name: str, condition: str) -> bool:
    """Whether a recording may be called so: by its condition or name, with a letter and number before it or none."""
    return re.fullmatch(rf"([A-Z]\d* )?{re.escape(condition or name)}", stated) is not None


def left_open(held: HeldLibrary, since: str = "") -> list[str]:
    """The recordings, begun at an ISO time or later, that nobody ends any more once nothing is being recorded."""
    rows = held.ask("SELECT name, started FROM recordings WHERE state = 'open' AND started >= ?", since)
    return [f"{name} of {started} is held as open" for name, started in rows]


def _number(words: str) -> int:
    found = re.search(r"\d+", words)
    return int(found[0]) if found is not None else 0


def _only(these: Counter[Any], those: Counter[Any]) -> list[Any]:
    return sorted((these - those).elements())
