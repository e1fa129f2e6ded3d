"""`gaitwright query`: one SQL question to the table of a batch, answered on the terminal or as a CSV file."""

import argparse
import os
import sys
from collections.abc import Iterator

from app.cohort.study.found_csv import aligned_lines, check_csv_place, csv_lines, write_csv
from app.cohort.study.parameter_table import VIEW, ParameterTable
from app.system.progress import Report
from devices.files.refusal import FileRefusedError, one_line


def run(args: argparse.Namespace, _report: Report) -> tuple[()]:
    """Print an answer while it comes, which may be larger than memory, until nobody reads it any more."""
    try:
        for line in query(args):
            print(line)
        sys.stdout.flush()
    except BrokenPipeError:  # as of `| head`
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    return ()


def query(args: argparse.Namespace) -> Iterator[str]:
    """Answer the question and give terminal lines as they come; raises FileRefusedError or OSError."""
    if bool(args.sql.strip()) == args.columns:
        what = "a question and --columns at once" if args.columns else "nothing is asked"
        raise FileRefusedError("SQL", what, "Give a SELECT in quotes, or --columns")
    if args.csv is not None:
        check_csv_place(args.csv, args.table)
        args.out = args.csv
    with ParameterTable.opened(args.table) as table:
        columns = f"SELECT column_name, column_type FROM (DESCRIBE {VIEW})"
        found = table.found(columns) if args.columns else table.ask(args.sql)
        if args.csv is not None:
            count = write_csv(found.columns, found.rows, args.csv)
            yield f"{one_line(str(args.csv))}: {count} {'row' if count == 1 else 'rows'}. Research use."
        else:
            as_lines = aligned_lines if sys.stdout.isatty() else csv_lines
            yield from as_lines(found.columns, found.rows)
