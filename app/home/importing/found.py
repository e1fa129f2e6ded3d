"""What files hold, read in one go: sessions to be confirmed, what could not be read, and tables that nobody knows."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING

from app.importing.import_drafts import SessionDraft, drafts_of
from app.importing.untrusted_files import gather_foreign, read_foreign_session, read_foreign_trial
from app.system.known_tables import known_tables
from app.system.progress import Report
from devices.files.refusal import FileRefusedError
from devices.files.table_choices import StatedChoices
from devices.files.table_layout import NAMELESS
from devices.files.trial import CSV, SESSION

if TYPE_CHECKING:
    from core.session import Session
    from devices.files.trial import ImportedTrial


@dataclass(frozen=True, slots=True)
class HowRead:
    """`choices`: what is stated of tables, before what is kept of them. `are_one`: see `gathering.gather`.

    `done`: files that were read before and are done with.
    """

    rate_hz: float | None = None
    choices: StatedChoices = field(default_factory=dict)
    are_one: bool = False
    done: frozenset[str] = frozenset()


@dataclass(frozen=True, slots=True)
class Found:
    """One session that was read, and where: that of a session folder, or a draft of one.

    `is_one_sensor`: of each of its files, by their format.
    """

    where: str
    files: tuple[str, ...]
    session: "Session | None" = None
    draft: SessionDraft | None = None
    is_one_sensor: bool = False

    @property
    def are_tables(self) -> bool:
        """Whether what its columns mean can be stated."""
        return self.draft is not None and self.draft.recordings[0].trial.format == CSV

    @property
    def is_part(self) -> bool:
        """Whether it may be one sensor of a recording whose other files are not called alike."""
        recordings = self.draft.recordings if self.draft is not None else ()
        return self.is_one_sensor and len(recordings) == 1 and len(recordings[0].trial.sensors) == 1


@dataclass(frozen=True, slots=True)
class FilesRead:
    """What came of reading. `again`: files of known programs that could not be read; `tables`: all that are tables."""

    found: tuple[Found, ...]
    refused: tuple[FileRefusedError, ...]
    again: tuple[Path, ...]
    tables: tuple[Path, ...]


def read_files(paths: Sequence[Path], how: HowRead, report: Report) -> FilesRead:
    """Read all that can be read of these files and folders; raises FileRefusedError where nothing more can be done."""
    report(0.0, paths[0].name)
    choices = {**_known(), **how.choices}
    gathered = gather_foreign(paths, lambda: report(0.0, paths[0].name), choices, are_one=how.are_one)
    refused, again, tables = list(gathered.refused), list[Path](), [Path(table) for table in gathered.tables]
    folders: list[Found] = []
    trials: list[tuple[str, ImportedTrial]] = []
    parts: dict[int, Found] = {}  # by the trial's identity
    for number, one in enumerate(gathered.trials):
        if how.done & set(one.files):
            continue
        share, files = number / len(gathered.trials), [Path(file) for file in one.files]

        def waiting(share: float = share, name: str = one.name) -> None:
            report(share, name)

        waiting()
        try:
            if one.format == SESSION:
                folders.append(Found(str(files[0]), one.files, read_foreign_session(files[0], waiting)))
                continue
            trial = read_foreign_trial(one.format, files, how.rate_hz, waiting, choices, splits=True)
        except FileRefusedError as refusal:
            refused.append(refusal)
            again += files if one.format != SESSION else []
            tables += files if one.format == CSV else []
            continue
        trials.append((one.name, trial))
        where = str(files[0].parent if len(files) > 1 else files[0])
        parts[id(trial)] = Found(where, one.files, is_one_sensor=one.is_one_sensor)
        tables += [Path(unread.file) for unread in trial.unread if one.format == CSV]
    drafts = [_drafted(draft, parts) for draft in drafts_of(trials)]
    if len(paths) == 1 and len(refused) == 1 and not folders and not drafts and not again and not tables:
        raise refused[0]
    return FilesRead((*folders, *drafts), tuple(refused), tuple(again), tuple(dict.fromkeys(tables)))


def _drafted(draft: SessionDraft, parts: dict[int, Found]) -> Found:
    of_draft = [parts[id(one.trial)] for one in draft.recordings]
    files = tuple(file for one in of_draft for file in one.files)
    return replace(of_draft[0], files=files, draft=draft)


def _known() -> StatedChoices:
    """What is kept of tables whose names show that they are the same program's; a rate is that of one recording."""
    kept = known_tables()
    return {key: replace(one, rate_hz=None) for key, one in kept.items() if not key.startswith(NAMELESS)}
