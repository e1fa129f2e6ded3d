"""Tests that a finished log is put in order, and a broken one refused."""

from pathlib import Path

import pytest

from app.review.rerun_log import BLUEPRINT, write_log
from app.review.rrd_file import PLACE_OF_TABLE, checksum, remove_chance
from core.results import Analysis, Method
from core.session import Session


@pytest.fixture
def log(tmp_path: Path) -> Path:
    write_log(Session(()), Analysis(Method.ROBUST, False, (), ()), tmp_path / "session.rrd")
    return tmp_path / "session.rrd"


def test_the_checksum_is_xxh32() -> None:
    # as the reference implementation prints them
    assert checksum(b"", seed=0) == 0x02CC5D05
    assert checksum(b"abc", seed=0) == 0x32D153FF
    assert checksum(b"Nobody inspects the spammish repetition", seed=0) == 0xE2293B2F


def test_a_file_in_order_stays_as_it_is(log: Path) -> None:
    before = log.read_bytes()
    remove_chance(log, BLUEPRINT, BLUEPRINT)
    assert log.read_bytes() == before


def test_a_log_that_was_not_written_to_its_end_is_an_os_error(log: Path) -> None:
    whole = log.read_bytes()
    place, *_ = PLACE_OF_TABLE.unpack(whole[-PLACE_OF_TABLE.size :])
    log.write_bytes(whole[: place - 20])
    with pytest.raises(OSError, match="too early"):
        remove_chance(log, BLUEPRINT, BLUEPRINT)


def test_a_table_that_is_cut_off_or_changed_is_refused(log: Path) -> None:
    whole = bytearray(log.read_bytes())
    place, *_ = PLACE_OF_TABLE.unpack(whole[-PLACE_OF_TABLE.size :])
    log.write_bytes(whole[:-10])
    with pytest.raises(ValueError, match="expected its place and checksum"):
        remove_chance(log, BLUEPRINT, BLUEPRINT)
    whole[place + 50] ^= 1
    log.write_bytes(whole)
    with pytest.raises(ValueError, match="expected its place and checksum"):
        remove_chance(log, BLUEPRINT, BLUEPRINT)
