"""The table can be asked and nothing else: no file is read or written, nothing is loaded, and refusals are one line."""

import math
import os
from collections.abc import Iterator
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from app.cohort.study.parameter_table import ParameterTable
from devices.files import limited_reader
from devices.files.refusal import FileRefusedError
from tests.app.cohort.study.study_tables import MEASURE, row, write_rows


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    place = tmp_path_factory.mktemp("table") / 'it\'s a "table".parquet'
    return write_rows([row("a", 60.0), row("b", math.nan, "withheld")], place)


@pytest.fixture(scope="module")
def table(path: Path) -> Iterator[ParameterTable]:
    with ParameterTable.opened(path) as opened:
        yield opened


def asked(table: ParameterTable, sql: str) -> list[tuple[object, ...]]:
    return list(table.ask(sql).rows)


def refused(table: ParameterTable, sql: str) -> str:
    with pytest.raises(FileRefusedError) as reported:
        asked(table, sql)
    assert "\n" not in str(reported.value)
    return str(reported.value)


@pytest.mark.parametrize(
    ("sql", "found"),
    [
        ("SELECT count(*) FROM parameters", 2),
        ("FROM parameters SELECT max(knee_range_deg)", 60.0),
        ("WITH x AS (SELECT session FROM parameters) SELECT min(session) FROM x;", "a"),
        ("-- a remark\nSELECT count(*) FROM (DESCRIBE parameters) WHERE column_name = 'session'", 1),
        ("VALUES (7)", 7),
    ],
)
def test_a_question_is_answered(table: ParameterTable, sql: str, found: object) -> None:
    assert asked(table, sql)[0][0] == found


def test_a_number_that_is_none_is_empty(table: ParameterTable) -> None:
    assert asked(table, f"SELECT {MEASURE} FROM parameters ORDER BY session") == [(60.0,), (None,)]
    assert asked(table, f"SELECT avg({MEASURE}), count({MEASURE}) FROM parameters") == [(60.0, 1)]


def test_a_folder_of_a_batch_is_for_its_table(tmp_path: Path) -> None:
    write_rows([row("a", 60.0)], tmp_path / "parameters.parquet")
    with ParameterTable.opened(tmp_path) as table:
        assert table.measures == ("walk_speed_m_s", MEASURE, "cadence_steps_min")


OUTSIDE = {
    "COPY TO": "COPY parameters TO '{out}'",
    "COPY of a question": "COPY (SELECT 1) TO '{out}' (FORMAT csv)",
    "COPY inside a question": "WITH x AS (COPY parameters TO '{out}') SELECT 1",
    "COPY over the table": "WITH x AS (COPY parameters TO '{table}' (USE_TMP_FILE false)) SELECT 1",
    "COPY to where a base in memory would be": "WITH x AS (COPY parameters TO ':memory:' (FORMAT csv)) SELECT 1",
    "COPY that is explained": "EXPLAIN ANALYZE COPY parameters TO '{out}'",
    "COPY FROM": "COPY parameters FROM '{secret}'",
    "EXPORT": "EXPORT DATABASE '{out}'",
    "read_csv": "SELECT * FROM read_csv('{secret}')",
    "read_text": "SELECT * FROM read_text('{secret}')",
    "read_blob": "SELECT * FROM read_blob('{secret}')",
    "read_json": "SELECT * FROM read_json('{secret}')",
    "sniff_csv": "SELECT * FROM sniff_csv('{secret}')",
    "glob": "SELECT * FROM glob('{folder}/*')",
    "a file as a table": "SELECT * FROM '{secret}'",
    "the table by its path": "SELECT * FROM read_parquet('{table}')",
    "a password file": "SELECT * FROM read_csv('/etc/passwd')",
    "the network": "SELECT * FROM 'https://example.com/x.parquet'",
    "described": "DESCRIBE SELECT * FROM read_csv('{secret}')",
    "query()": "SELECT * FROM query('COPY parameters TO ''{out}''')",
    "ATTACH": "ATTACH '{out}' AS other",
    "INSTALL": "INSTALL httpfs",
    "LOAD": "LOAD httpfs",
    "PRAGMA": "PRAGMA version",
    "SET": "SET threads = 4",
    "RESET": "RESET lock_configuration",
    "CALL": "CALL pragma_version()",
    "EXPLAIN": "EXPLAIN SELECT 1",
    "CREATE": "CREATE TABLE t AS SELECT 1",
    "DROP": "DROP VIEW parameters",
    "UPDATE": "UPDATE parameters SET session = 'x'",
    "INSERT inside a question": "WITH x AS (INSERT INTO parameters VALUES (1)) SELECT 1",
    "PREPARE": "PREPARE p AS SELECT 1",
    "BEGIN": "BEGIN",
    "the query contains two statements": "SELECT 1; SELECT 2",
    "a second that writes": "SELECT 1; COPY parameters TO '{out}'",
    "none": " ; -- nothing",
    "a Python object": "SELECT * FROM somebodys_rows",
}


def test_nothing_but_the_table_can_be_reached(
    path: Path, table: ParameterTable, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    somebodys_rows = pa.table({"a": [1]})  # which DuckDB would find by its name in the frames above
    folder = tmp_path / "beside"
    folder.mkdir()
    monkeypatch.chdir(folder)
    secret = folder / "secret.csv"
    secret.write_text("name\nnobody's business\n")
    before = path.read_bytes()
    places = {"out": folder / "out", "secret": secret, "folder": folder, "table": path}
    quoted = {name: str(place).replace("'", "''") for name, place in places.items()}
    for what, sql in OUTSIDE.items():
        assert "business" not in refused(table, sql.format(**quoted)), what
        assert os.listdir(folder) == ["secret.csv"], what  # noqa: PTH208 - names are enough
        assert path.read_bytes() == before, what
    assert somebodys_rows.num_rows == 1


def test_the_configuration_is_locked_down(table: ParameterTable) -> None:
    required = {
        "enable_external_access": "false",
        "lock_configuration": "true",
        "autoinstall_known_extensions": "false",
        "autoload_known_extensions": "false",
        "allow_community_extensions": "false",
        "allow_unsigned_extensions": "false",
        "python_enable_replacements": "false",
        "allowed_paths": "[]",
        "allowed_directories": "[]",
        "temp_directory": "",
        "threads": "2",
    }
    names = ", ".join(f"'{name}'" for name in required)
    found = asked(table, f"SELECT name, coalesce(value, '') FROM duckdb_settings() WHERE name IN ({names})")
    assert {str(name): str(value) for name, value in found} == required


@pytest.mark.parametrize(
    ("sql", "named"),
    [
        ("SELECT knee FROM parameters", 'Referenced column "knee" not found'),
        ("SELECT 1 FROM parmeters", 'Table with name parmeters does not exist (Did you mean "parameters")'),
        ("SELEC 1", 'syntax error at or near "SELEC"'),
        ("SELECT avg(session) FROM parameters", "avg(VARCHAR)"),
        ("SELECT session::DOUBLE FROM parameters", "Could not convert string 'a' to DOUBLE"),
        ("SELECT ?", "Values were not provided"),
        ("SELECT now()", "now()::VARCHAR"),
        ("PIVOT parameters ON side USING count(*)", "PIVOT without IN"),
    ],
)
def test_what_cannot_be_answered_is_named_in_one_line_without_a_mark(
    table: ParameterTable, sql: str, named: str
) -> None:
    stated = refused(table, sql)
    assert named in stated
    assert "Error:" not in stated
    assert "!" not in stated


@pytest.mark.parametrize(
    "sql",
    ["SELECT list(range) FROM range(1000000000)", "SELECT length(repeat('x', 4000000000))"],
)
def test_a_question_that_takes_too_much_memory_is_refused_and_the_next_is_answered(
    table: ParameterTable, sql: str
) -> None:
    assert "memory" in refused(table, sql)
    assert asked(table, "SELECT count(*) FROM parameters") == [(2,)]


@pytest.mark.parametrize(
    "sql",
    [
        "SELECT sleep_ms(600000)",
        "WITH RECURSIVE t(n) AS (SELECT 1 UNION ALL SELECT n + 1 FROM t) SELECT count(*) FROM t",
    ],
)
def test_a_question_that_never_ends_is_ended(table: ParameterTable, monkeypatch: pytest.MonkeyPatch, sql: str) -> None:
    monkeypatch.setattr(limited_reader, "DEADLINE_S", 0.2)
    with pytest.raises(FileRefusedError, match="this query exceeds the time limit"):
        table.ask(sql)


def test_what_is_no_table_of_a_batch_is_refused(tmp_path: Path) -> None:
    other, broken, empty = (tmp_path / name for name in ("other.parquet", "broken.parquet", "empty"))
    pq.write_table(pa.table({"session": ["a"], "walk": ["1"]}), other)
    broken.write_bytes(b"PAR1 and no more")
    empty.mkdir()
    for place, stated in (
        (other, "column side is missing"),
        (broken, "the file is not a readable Parquet file"),
        (empty, "parameters.parquet: not found"),
        (tmp_path / "nothing.parquet", "not found"),
    ):
        with pytest.raises(FileRefusedError) as reported, ParameterTable.opened(place):
            pass
        assert stated in str(reported.value)
        assert "\n" not in str(reported.value)


def test_a_column_called_like_sql_stays_a_column(tmp_path: Path) -> None:
    path = tmp_path / "p.parquet"
    odd = 'x"; DROP VIEW parameters; --'
    pq.write_table(
        pa.table({"session": ["a"], "walk": ["1"], "side": ["left"], odd: [1.5], f"{odd}_status": ["read"]}), path
    )
    with ParameterTable.opened(path) as table:
        assert table.measures == (odd,)
        assert next(table.ask("SELECT COLUMNS('DROP') FROM parameters").rows)[0] == 1.5
