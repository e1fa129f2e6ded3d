"""`gaitwright query`: one SQL question to the table of a batch, answered on the terminal or as a CSV file."""

import argparse
import sys
from collections.abc import Iterator
from pathlib import Path

from devices.files.refusal import FileRefusedError, one_line

ON_TERMINAL = "The terminal"  # in the place of a file's name in what is stated about interruptions
EXAMPLE = "SELECT condition, count(DISTINCT session), avg(knee_range_deg) FROM parameters GROUP BY condition"


def add_query_arguments(parser: argparse.ArgumentParser) -> None:
    parser.description = (
        "Answer a question in SQL (that of DuckDB) over the table of a batch, which is called parameters. It is only "
        f'read, and nothing else can be. For example: "{EXAMPLE}".'
    )
    parser.add_argument("sql", metavar="SQL", nargs="?", default="", help="one SELECT")
    parser.add_argument(
        "--in",
        dest="table",
        metavar="PARQUET",
        type=Path,
        required=True,
        help="the parameters.parquet of a batch, or the folder that holds it",
    )
    parser.add_argument("--out", dest="csv", metavar="CSV", type=Path, help="the CSV file to write (the terminal)")
    parser.add_argument("--columns", action="store_true", help="list the columns of the table instead")
    parser.set_defaults(out=ON_TERMINAL)


def query(args: argparse.Namespace) -> Iterator[str]:
    """Answer the question and give the lines for the terminal, as they come.

    Raises
    ------
    FileRefusedError
        The table cannot be read, the question cannot be answered, or something else is at --out.
    OSError
        The CSV file cannot be written.
    """
    from app.cohort.study.found_csv import aligned_lines, check_csv_place, csv_lines, write_csv
    from app.cohort.study.parameter_table import VIEW, ParameterTable

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
