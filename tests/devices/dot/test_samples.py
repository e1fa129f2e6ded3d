"""Tests that a Movella DOT's samples are read as laid out.

They come whole, cut, in pieces, and when its clock begins again.
"""

import math
import struct

import numpy as np
import pytest

from devices.dot.decoder import DotDecoder, file_settings
from devices.dot.messages import DotMessage, RecordedFile
from devices.dot.samples import DotFramer, FileFramer
from devices.source import SourceInfo
from devices.stream import Row
from devices.transport.notifications import framed

STEP_US, TURN = 16667, 1 << 32
VALUES = (0.5, -0.5, 0.5, 0.5, 1.0, -2.0, 9.75, 90.0, -180.0, 360.0)  # exact in single precision


def long(ticks: int) -> bytes:
    return framed(0x2002, struct.pack("<I10f", ticks % TURN, *VALUES) + bytes(19))


def medium(ticks: int) -> bytes:
    return framed(0x2003, struct.pack("<I6f", ticks % TURN, *VALUES[4:]) + bytes(12))


def framer(mode: int = 26) -> DotFramer:
    return DotFramer(SourceInfo("movella-dot", "1", settings={"mode": mode}))


def is_row(row: Row, ticks: int) -> bool:
    return row == pytest.approx((ticks / 1e6, math.pi / 2, -math.pi, 2 * math.pi, 1.0, -2.0, 9.75))


def test_a_notification_lies_in_the_journal_as_characteristic_length_payload() -> None:
    assert framed(0x2003, b"\x01\x02\x03").hex() == "03200300010203"


def test_both_modes_are_read_and_their_padding_is_not() -> None:
    full, plain = framer(26), framer(21)
    full.feed(long(5_000_000), 5.1)
    plain.feed(medium(5_000_000), 5.1)
    assert is_row(full.received.rows[0], 5_000_000)
    assert is_row(plain.received.rows[0], 5_000_000)
    assert full.received.orientations == [(5.0, 0.5, -0.5, 0.5, 0.5)]
    assert plain.received.orientations == []


def test_a_notification_cut_to_20_bytes_is_damaged_and_costs_no_other() -> None:
    one = framer()
    one.feed(long(0) + framed(0x2002, bytes(20)) + long(2 * STEP_US), 0.1)
    assert (len(one.received.rows), one.received.damaged) == (2, 1)


def test_what_is_no_number_is_damaged() -> None:
    one = framer()
    one.feed(framed(0x2002, struct.pack("<I10f", 0, *VALUES[:-1], math.nan)), 0.1)
    assert (len(one.received.rows), one.received.damaged) == (0, 1)


def test_another_mode_s_notification_is_passed_over_and_the_battery_is_received() -> None:
    one = framer(26)
    one.feed(medium(0) + framed(0x3001, b"\x55\x00"), 0.1)
    assert (one.received.rows, one.received.skipped, one.received.battery) == ([], 1, 0.85)


@pytest.mark.parametrize("size", [1, 3, 7, 50, 1000])
def test_what_is_received_does_not_hang_on_the_pieces(size: int) -> None:
    data = b"".join(long(k * STEP_US) for k in range(20)) + framed(0x3001, b"\x20\x00")
    one = framer()
    for at in range(0, len(data), size):
        one.feed(data[at : at + size], 0.5)
    one.flush()
    assert (len(one.received.rows), one.received.damaged, one.received.battery) == (20, 0, 0.32)


def test_after_damage_the_next_notification_is_found() -> None:
    one = framer()
    one.feed(long(0) + b"\xff\x00\xff" + long(STEP_US) + long(2 * STEP_US)[:9], 0.1)
    one.flush()
    assert (len(one.received.rows), one.received.damaged) == (2, 2)


def test_the_clock_goes_on_where_it_begins_again_and_after_a_break() -> None:
    begin_us = TURN - 3 * STEP_US
    one = framer()
    for k in range(6):
        one.feed(long(begin_us + k * STEP_US), 4295.0 + k * STEP_US / 1e6)
    stamps_s = [row[0] for row in one.received.rows]
    assert np.allclose(np.diff(stamps_s), STEP_US / 1e6, atol=1e-9)
    again = framer()  # the link was lost, and what follows is read by another one
    again.feed(long(begin_us + 60 * STEP_US), 4296.0)
    assert again.received.rows[0][0] == pytest.approx(stamps_s[0] + 60 * STEP_US / 1e6)


# files


def data(number: int, ticks: int, *, kind: int = 0x71) -> bytes:
    stated = bytes([kind]) + struct.pack("<II10fH", number, ticks % TURN, *VALUES, 0)
    message = bytes([1, len(stated)]) + stated
    message += bytes([-sum(message) % 256])
    return framed(0x7003, message + bytes(160 - len(message)))


def test_a_file_is_put_together_from_what_came_in_any_order_and_twice_also_where_its_clock_begins_again() -> None:
    one = FileFramer()
    for number in (0, 1, 2, 6, 7, 2, 3):
        one.feed(data(number, TURN - 2 * 8333 + number * 8333))
    assert one.missing() == (range(4, 6),)
    rows, orientations = one.rows()
    begin_s = (TURN - 2 * 8333) / 1e6
    assert [row[0] for row in rows] == pytest.approx([begin_s + k * 0.008333 for k in (0, 1, 2, 3, 6, 7)])
    assert rows[0][1:] == pytest.approx((math.pi / 2, -math.pi, 2 * math.pi, 1.0, -2.0, 9.75))
    assert orientations[0][1:] == (0.5, -0.5, 0.5, 0.5)


def test_a_notification_of_a_file_that_was_cut_where_the_link_was_lost_costs_none_of_what_follows() -> None:
    source = SourceInfo("movella-dot", "1", "", ("DOT 0001",), file_settings(RecordedFile(1, 1_600_000_000), 120.0))
    decoder = DotDecoder()
    decoder.begin(source)
    decoder.feed(data(0, 0) + data(1, 8333) + data(2, 16667)[:30], 0.0)
    decoder.begin(source)
    decoder.feed(b"".join(data(number, round(number * 8333.3)) for number in range(2, 10)), 1.0)
    one = decoder.finish()["DOT 0001"]
    assert (len(one.block), one.counts.lost, one.counts.damaged) == (10, 0, 0)


@pytest.mark.parametrize("more", [b"", b"\0\0\0\0"], ids=["as it was chosen", "with more than was chosen"])
def test_what_is_laid_out_otherwise_than_was_chosen_is_damaged_and_not_misread(more: bytes) -> None:
    one = FileFramer()
    stated = b"\x71" + struct.pack("<II", 0, 8333) + more + struct.pack("<10fH", *VALUES, 0)
    one.feed(framed(0x7003, DotMessage(1, stated).packed()))
    assert (len(one.samples), one.damaged) == ((0, 1) if more else (1, 0))


def test_damaged_data_of_a_file_is_missing_and_stated_to_be() -> None:
    one = FileFramer()
    changed = bytearray(data(1, 8333))
    changed[20] ^= 1
    one.feed(data(0, 0) + bytes(changed) + data(2, 16667) + framed(0x7003, bytes.fromhex("01017688")))
    assert (sorted(one.samples), one.missing(), one.damaged) == ([0, 2], (range(1, 2),), 1)
