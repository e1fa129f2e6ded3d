"""`gaitwright import`: recordings of another program, added to a session folder, or a preview of its tables."""

import argparse
import csv
import io
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from shlex import quote

from app.cli.arguments import DECIMALS, SEPARATORS
from app.cli.progress import finding_lines
from app.importing.splitting import clock_view_of, split_all
from app.importing.untrusted_files import (
    gather_foreign,
    preview_foreign_table,
    read_foreign_session,
    read_foreign_trial,
    write_over_session,
)
from app.system.progress import Report
from app.system.tables import is_free
from app.wording.clock_events import clock_sentence
from core.body import LEG_SITES, Site
from core.session import Recording, RecordingKind, Session
from devices.files.imports import (
    AS_IN,
    MAP,
    add_recording,
    folder_for,
    free_name,
    mapped_sites,
    parse_map,
    place_trial,
)
from devices.files.refusal import FileRefusedError, one_line
from devices.files.table_choices import ALL_TABLES, NONE, NOTHING_STATED, TableChoices
from devices.files.trial import CSV, ImportedTrial


def run(args: argparse.Namespace, progress: Report) -> list[str]:
    """Add the recording, or those it is split into, and give the lines for the terminal.

    Raises
    ------
    FileRefusedError
        The files are not what they should be, or do not fit the session.
    OSError
        The session cannot be written.
    """
    stated = _stated(args)
    if args.preview:
        with_rate = replace(stated, rate_hz=args.rate)
        return [line for path in args.files for line in _preview(path, with_rate, progress)]
    if args.map is None:
        raise FileRefusedError(MAP, "no sensor position is given", AS_IN)
    kind = RecordingKind(args.kind)
    mapping = Path(args.map) if "=" not in args.map and args.map.lower().endswith(".xml") else None
    placement = parse_map(args.map) if mapping is None else {}
    files = args.files if mapping is None else [*args.files, mapping]
    session = Session(()) if is_free(args.out) else read_foreign_session(args.out, lambda: progress(0.0, str(args.out)))
    name = args.recording or free_name(session, kind)
    progress(0.0, name)
    choices = {ALL_TABLES: stated} if stated.are_any else NOTHING_STATED
    trial = read_foreign_trial(args.format or "", files, args.rate, lambda: progress(0.0, name), choices, splits=True)
    placement = placement or mapped_sites(trial)
    lines = []
    for number, part in enumerate(split_all(trial, args.split_at or []), start=1):
        called = name if number == 1 else f"{args.recording} {number}" if args.recording else free_name(session, kind)
        imported = place_trial(part, placement, called, is_one_receiver=args.one_receiver)
        recording = Recording(called, kind, folder_for(called), imported.imu)
        session = add_recording(session, recording, imported.sensors, imported.findings, imported.is_simulated)
        sites = len(Site) if Site.PELVIS in imported.imu else len(LEG_SITES)
        lines.append(f"{args.out} now holds {called}, with {len(imported.imu)} of {sites} sites.")
        lines += [*_of_clocks(part), *finding_lines(imported.findings, lowest="info")]
    progress(0.5, str(args.out))
    write_over_session(session, args.out)
    return lines


def _of_clocks(trial: ImportedTrial) -> Iterator[str]:
    """What befell its clocks, in words."""
    names = [sensor.name for sensor in trial.sensors]
    for event in clock_view_of(trial).events:
        yield f"- {one_line(clock_sentence(event, names))}"


def _stated(args: argparse.Namespace) -> TableChoices:
    """What the options state of all tables; the rate is an option of every format."""
    return TableChoices(
        encoding=args.encoding or "",
        header_line=args.header_line,
        separator=SEPARATORS.get(args.separator, ""),
        decimal=DECIMALS.get(args.decimal, ""),
        acc=args.acc or (),
        acc_unit=args.acc_unit or "",
        gyr=args.gyr or (),
        gyr_unit=args.gyr_unit or "",
        time=args.time or "",
        time_unit=args.time_unit or "",
        sensor=args.sensor_column or "",
    )


def _preview(path: Path, stated: TableChoices, progress: Report) -> Iterator[str]:
    """How a table is read, in the words of the options."""
    preview = preview_foreign_table(path, stated, lambda: progress(0.0, path.name))
    yield f"{one_line(path.name)}:"
    known = gather_foreign([path], lambda: progress(0.0, path.name)).trials
    if known and known[0].format != CSV:
        yield f"  recognised as {known[0].format}, and read so unless something is stated of its columns"
        if preview.refusal is not None and not stated.are_any:
            return
    if preview.columns:
        yield f"  columns: {', '.join(f'{number} {one_line(name)}' for number, name in enumerate(preview.columns, 1))}"
        yield f"  read with: {' '.join(_options(preview.found))}"
    if preview.is_by_values:
        yield "  The columns were found by their values alone: check them."
    for sensor in preview.sensors:
        rate = f"{sensor.rate_hz:g} Hz" if sensor.rate_hz else "no rate"
        yield f"  sensor {one_line(sensor.name)}: {rate}, {sensor.length_s:.1f} s{' at least' * preview.is_cut}"
    for refusal in preview.unread:
        yield f"  not read: {refusal}"
    if preview.refusal is not None:
        yield f"  {preview.refusal}"


def _options(found: TableChoices) -> Iterator[str]:
    names = {sign: name for name, sign in SEPARATORS.items()}
    yield f"--encoding {found.encoding} --header-line {found.header_line} --separator {names.get(found.separator, '-')}"
    yield f"--decimal {'comma' if found.decimal == ',' else 'point'}"
    for option, columns, unit in (("acc", found.acc, found.acc_unit), ("gyr", found.gyr, found.gyr_unit)):
        if columns:
            yield f"--{option} {_quoted(columns)}" + (f" --{option}-unit {unit}" if unit else "")
    yield f"--time {quote(one_line(found.time))}" + (f" --time-unit {found.time_unit}" if found.time_unit else "")
    if found.sensor != NONE:
        yield f"--sensor-column {quote(one_line(found.sensor))}"
    if found.rate_hz:
        yield f"--rate {found.rate_hz:g}"


def _quoted(columns: Sequence[str]) -> str:
    """Names as `arguments.three_columns` and a shell take them apart."""
    text = io.StringIO()
    csv.writer(text, lineterminator="").writerow(map(one_line, columns))
    return quote(text.getvalue())
