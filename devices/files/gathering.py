"""Files put together to trials: those of a program that writes one for each sensor, by their names."""

from collections.abc import Sequence
from pathlib import Path

from devices.files.csv_tables import choices_for
from devices.files.formats import format_of, known_format, why_not_recognised
from devices.files.refusal import FileRefusedError
from devices.files.sensor_mapping import is_mapping, read_mapping
from devices.files.session_toml import FILE_NAME
from devices.files.site_names import without_site
from devices.files.table_choices import NOTHING_STATED, StatedChoices
from devices.files.table_layout import fingerprint_of
from devices.files.trial import CSV, SESSION, FilesOfTrial, Gathered

MOST_FILES = 500  # what is dragged may be a whole disk


def gather(
    paths: Sequence[Path],
    choices: StatedChoices = NOTHING_STATED,
    *,
    are_one: bool = False,
    with_others: bool = False,
) -> Gathered:
    """Group files to trials by format, folder and common name, in the order of names; a folder of no format is opened.

    What is refused is returned beside them; raises FileRefusedError where there are no files, or too many. `choices`:
    what somebody states of tables. `are_one`: files of one sensor each are one trial, whatever their names.
    `with_others`: a file that is of none of our formats is shown to those of other packages.
    """
    refused: list[FileRefusedError] = []
    tables: list[str] = []
    found: dict[tuple[str, Path, str], list[str]] = {}
    mappings: list[Path] = []
    for path in _opened_up(paths, refused):
        try:
            if is_mapping(path):
                mappings.append(path)
                continue
            is_stated = choices_for(path, choices) is not None
            name = CSV if is_stated else _format(path, with_others)
        except OSError as problem:
            refused.append(_unreadable(path, problem))
            continue
        except FileRefusedError as refusal:  # what holds no tables is opened to be recognised, and may be damaged
            refused.append(refusal)
            continue
        if name is None:
            refused.append(why_not_recognised(path))
            tables += [str(path)] if path.is_file() and fingerprint_of(path) else []
            continue
        is_merged = are_one and name != SESSION and known_format(name).is_one_sensor
        common = path.parent.name if is_merged else _common(name, path)
        found.setdefault((name, path.parent, common), []).append(str(path))
    if not found and mappings and not refused:
        raise FileRefusedError(
            mappings[0].name,
            "the file names sensors and holds no recording",
            "Choose the recordings together with this file",
        )
    if not found and not refused:
        raise FileRefusedError(
            paths[0].name,
            "the folder contains neither session.toml nor a file that can be imported",
            "Choose the folder with the recordings",
        )
    trials = tuple(
        FilesOfTrial(
            name,
            (common if len(files) > 1 else Path(files[0]).stem) or folder.name,
            (*files, *(str(path) for path in mappings if path.parent == folder and _is_named_by(path, name, files))),
            name != SESSION and known_format(name).is_one_sensor,
        )
        for (name, folder, common), files in found.items()
    )
    return Gathered(trials, tuple(refused), tuple(tables))


def _format(path: Path, with_others: bool) -> str | None:
    return SESSION if (path / FILE_NAME).is_file() else format_of(path, with_others=with_others)


def _is_named_by(mapping: Path, name: str, files: Sequence[str]) -> bool:
    """Whether a mapping may name sensors of these files: one of each is named by its id, which its file's name has."""
    if name == SESSION or not known_format(name).is_one_sensor:
        return name != SESSION
    try:
        ids = read_mapping(mapping)
    except FileRefusedError:
        return True  # whoever reads it is told why
    return any(key in Path(file).stem.upper() for key in ids for file in files)


def _common(name: str, path: Path) -> str:
    """What the names of the files of one trial have in common."""
    if name == SESSION:
        return path.name
    own = known_format(name)
    if own.trial_name is not None:
        return own.trial_name(path)
    return without_site(path.stem) if own.is_one_sensor else path.name


def _unreadable(path: Path, problem: OSError) -> FileRefusedError:
    why = problem.strerror or type(problem).__name__
    return FileRefusedError(path.name, "the file or folder cannot be read ({why})", "Check the permissions", why=why)


def _opened_up(paths: Sequence[Path], refused: list[FileRefusedError]) -> list[Path]:
    opened: list[Path] = []
    for path in sorted(set(paths)):
        try:
            if path.is_dir() and not (path / FILE_NAME).is_file() and format_of(path) is None:
                opened += sorted(inner for inner in path.iterdir() if not inner.name.startswith("."))
            else:
                opened.append(path)
        except OSError as problem:
            refused.append(_unreadable(path, problem))
        if len(opened) > MOST_FILES:
            raise FileRefusedError(
                path.name,
                "there are more than {count} files",
                "Choose the files of a few sessions at a time",
                count=MOST_FILES,
            )
    return opened
