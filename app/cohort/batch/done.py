"""What a batch has done already, kept beside its results: one small file for each session.

They are in a folder of their own, since the folder of a session's results holds only what `analyse` writes. A record
states of what the results were made and holds their rows of the table. It is written beside and renamed after the
results were: whatever is killed in between is done again, and nothing else.
"""

import hashlib
import json
import secrets
import shutil
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from pathlib import Path

from app.cohort.batch.rows import Row
from app.storage.files import held, replace_file
from app.system.tables import read_json
from devices.files.refusal import FileRefusedError

FORMAT = "gaitwright-batch/1"
FOLDER = ".gaitwright-batch"
ABOUT, DONE, WORK, LOCK = "batch.json", "done", "work", "lock"
MARK_BYTES = 32


@dataclass(frozen=True, slots=True)
class DoneRecord:
    """What the results of one session were made of (`key`), with what (`making`), and what they are."""

    key: str
    making: str
    summary_sha256: str
    rows: tuple[Row, ...]


@dataclass(frozen=True, slots=True)
class BatchFolder:
    """OUT of a batch. `mark` is its own: whoever reads the same one sees the same folder, not one of the same name."""

    out: Path
    mark: str

    @property
    def work(self) -> Path:
        """Where results are written until they are whole; what a killed worker left there is swept out."""
        return self.out / FOLDER / WORK

    def results(self, name: str) -> Path:
        return self.out / name

    def record(self, name: str) -> DoneRecord | None:
        """What is kept of a session; None where there is nothing, or nothing whole."""
        try:
            reported = json.loads(self._path(name).read_text(encoding="utf-8"))
            return DoneRecord(reported["key"], reported["making"], reported["summary_sha256"], tuple(reported["rows"]))
        except (OSError, ValueError, KeyError, TypeError):
            return None

    def keep(self, name: str, record: DoneRecord) -> None:
        """Keep that a session is done, whole or not at all; raises OSError."""
        _replace(self._path(name), asdict(record))

    def forget(self, name: str) -> None:
        """Keep nothing of a session that failed, so that the table has no old rows of it; raises OSError."""
        self._path(name).unlink(missing_ok=True)

    def _path(self, name: str) -> Path:
        digest = hashlib.sha256(
            name.encode("utf-8", "surrogateescape")
        ).hexdigest()  # a name may be as long as a disk takes
        return self.out / FOLDER / DONE / f"{digest}.json"


def read_mark(out: Path) -> str | None:
    """The mark of the batch at `out`; None where there is none, or none that is seen from here."""
    mark = (read_json(out / FOLDER / ABOUT, FORMAT) or {}).get("mark")
    return mark if isinstance(mark, str) else None


@contextmanager
def batch_at(out: Path) -> Iterator[BatchFolder]:
    """Hold the batch at `out`, existing or new, alone; raises FileRefusedError for other content or users."""
    out = out.resolve()
    mark = read_mark(out)
    if mark is None:
        if out.exists() and not (out.is_dir() and _is_begun_or_empty(out)):
            raise FileRefusedError(str(out), "this already exists and is not a batch analysis", "Choose another --out")
        (out / FOLDER).mkdir(parents=True, exist_ok=True)
    try:
        with held(out / FOLDER / LOCK):
            mark = read_mark(out) or _begun(out)
            batch = BatchFolder(out, mark)
            (out / FOLDER / DONE).mkdir(exist_ok=True)
            shutil.rmtree(batch.work, ignore_errors=True)
            batch.work.mkdir()
            try:
                yield batch
            finally:
                shutil.rmtree(batch.work, ignore_errors=True)
    except BlockingIOError as problem:
        what = "another program is working at this batch"
        raise FileRefusedError(str(out), what, "Wait until it is done, or choose another --out") from problem


def _begun(out: Path) -> str:
    mark = secrets.token_hex(MARK_BYTES)
    _replace(out / FOLDER / ABOUT, {"format": FORMAT, "mark": mark})
    return mark


def _replace(path: Path, content: Mapping[str, object]) -> None:
    replace_file(path, json.dumps(content, allow_nan=False).encode())


def _is_begun_or_empty(out: Path) -> bool:
    """Nothing is there, or only what a batch makes before all else, killed just then."""
    return all(path.name == FOLDER for path in out.iterdir())
