"""Tests that a Movella DOT's messages are those that its maker printed, byte by byte."""

import pytest

from devices.dot import messages
from devices.dot.messages import (
    DotAnswer,
    DotInfo,
    DotMessage,
    DotMessageError,
    DotSettings,
    Order,
    RecordedFile,
    StreamControl,
    SyncResult,
    answered,
    files_listed,
    recording_order,
    start_sync,
)

RECORD_UTC_S = 0x5B3B50DF
INFO = bytes.fromhex("CCBBAACD22D4020400E6070C1F173B3A010000000E01B0230003444258532D543032")


# what is written, as it is printed


@pytest.mark.parametrize(
    ("stated", "printed"),
    [
        (messages.SYNC_STATUS.packed(), "020108F5"),
        (messages.STOP_SYNC.packed(), "020102FB"),
        (start_sync("D4:22:CD:AA:BB:CC").packed(), "020701CCBBAACD22D402"),
        (recording_order(Order.GET_STATE).packed(), "010102FC"),
        (messages.start_recording(RECORD_UTC_S).packed(), "010740DF503B5BFFFFF5"),
        (recording_order(Order.STOP).packed(), "010141BD"),
        (recording_order(Order.LIST).packed(), "010150AE"),
        (recording_order(Order.FILE_INFO, b"\x01").packed(), "010260019C"),
        (recording_order(Order.CHOOSE, bytes([0, 1, 7, 8])).packed(), "0105740001070876"),
        (recording_order(Order.FETCH, b"\x01").packed(), "010270018C"),
        (messages.fetch_from(10).packed(), "0105750A0000007B"),
        (recording_order(Order.BREAK_OFF).packed(), "0101738B"),
        (messages.setting_rate(120), "10" + "00" * 23 + "7800" + "00" * 6),
        (messages.setting_profile(1), "20" + "00" * 25 + "01" + "00" * 5),
        (messages.identifying(), "0101" + "00" * 30),
        (messages.switching(26, is_on=True), "01011A"),
        (messages.switching(21, is_on=False), "010015"),
    ],
)
def test_what_is_written_is_what_is_printed(stated: bytes, printed: str) -> None:
    assert stated.hex().upper() == printed


def test_erasing_names_the_memory_and_when_and_its_bytes_add_up() -> None:
    stated = messages.erase(RECORD_UTC_S).packed()
    assert stated[:-1].hex() == "010530df503b5b"
    assert sum(stated) % 256 == 0


def test_a_rate_that_no_sensor_has_is_not_written() -> None:
    with pytest.raises(ValueError, match="100 Hz"):
        messages.setting_rate(100)


# what is answered, as it is printed


def received(printed: str, padding: int = 0) -> DotMessage:
    return DotMessage.parsed(bytes.fromhex(printed) + bytes(padding))


@pytest.mark.parametrize("padding", [0, 1, 140])
def test_answers_mean_what_is_printed_however_they_are_padded(padding: int) -> None:
    assert received("02025109A2", padding) == messages.IS_NOT_SYNCHRONISED
    assert received("02025104A7", padding) == messages.IS_SYNCHRONISED
    assert received("02025000AC", padding) == messages.SYNC_STOPPED
    assert SyncResult.of(received("02020300F9", padding)) is SyncResult.GOOD
    assert SyncResult.of(received("0209030001CCBBAACD22D4FD", padding)) is SyncResult.GOOD, "as it is drawn elsewhere"
    assert answered(Order.GET_STATE, received("0103010602F3", padding)) is DotAnswer.IDLE
    assert answered(Order.START, received("0109010040DF503B5BFFFFF2", padding)) is DotAnswer.DONE
    assert answered(Order.STOP, received("0103010041BA", padding)) is DotAnswer.DONE
    assert answered(Order.CHOOSE, received("01070100740001070873", padding)) is DotAnswer.DONE


@pytest.mark.parametrize("printed", ["010152AC", "0101639B", "0101728C", "010141BD"])
def test_notices_are_whole(printed: str) -> None:
    assert received(printed).group == messages.RECORDING_GROUP


@pytest.mark.parametrize("code", [5, 7, 8, 9])
def test_each_failure_of_synchronising_is_reported_apart(code: int) -> None:
    assert SyncResult.of(DotMessage(2, bytes([3, code]))) == code


@pytest.mark.parametrize("data", [b"\x03", b"\x03\x63", b"\x50\x00", b""])
def test_what_is_no_result_of_synchronising_is_unknown(data: bytes) -> None:
    assert SyncResult.of(DotMessage(2, data)) is SyncResult.UNKNOWN


def test_an_answer_to_another_order_is_no_answer() -> None:
    assert answered(Order.START, received("0103010041BA")) is DotAnswer.UNKNOWN
    assert answered(Order.STOP, DotMessage(1, b"\x01\x99\x41")) is DotAnswer.UNKNOWN
    assert answered(Order.STOP, DotMessage(1, b"\x01\x03\x41")) is DotAnswer.BUSY


@pytest.mark.parametrize("printed", ["", "02", "020251", "02025109", "02025109A3", "02035109A2"])
def test_what_is_cut_or_changed_is_no_message(printed: str) -> None:
    with pytest.raises(DotMessageError):
        received(printed)


# what characteristics hold


def test_a_sensor_states_who_it_is() -> None:
    assert DotInfo.parsed(INFO) == DotInfo("D4:22:CD:AA:BB:CC", (2, 4, 0), "4244030023B0010E", "DOT v2")
    assert DotInfo.parsed(INFO).can_synchronise
    assert not DotInfo.parsed(INFO[:6] + b"\x01\x03\x07" + INFO[9:]).can_synchronise
    with pytest.raises(DotMessageError):
        DotInfo.parsed(INFO[:33])


def test_settings_and_the_stream_are_read_where_they_stand() -> None:
    assert DotSettings.parsed(bytes(24) + b"\x3c\x00\x01" + bytes(5)) == DotSettings(60, 1)
    assert StreamControl.parsed(b"\x01\x01\x1a") == StreamControl(is_on=True, mode=26)
    assert StreamControl.parsed(b"\x01\x00\x15") == StreamControl(is_on=False, mode=21)
    with pytest.raises(DotMessageError):
        DotSettings.parsed(bytes(20))
    with pytest.raises(DotMessageError):
        StreamControl.parsed(b"\x01")


# the memory


HEADER = bytes.fromhex("73616C46 80000000 0200 00EEEE5E 0000F400 09000000") + bytes(106)  # its bytes look like files


def test_a_list_shows_how_many_files_there_are_and_how_large_whatever_its_header_holds() -> None:
    assert len(HEADER) == 128
    assert files_listed(HEADER + bytes.fromhex("EECCCCEEEECCFFFFFF")) == (2, 0, 1)
    assert files_listed(HEADER + b"\xff" * 8) == ()
    assert files_listed(HEADER) == ()
    for cut in (b"", HEADER[:7], HEADER[:127], b"\0" + HEADER):
        with pytest.raises(DotMessageError):
            files_listed(cut)


def test_a_file_shows_when_it_was_begun_and_not_how_long_it_is() -> None:
    """Without a timer FFFF is where its length might be looked for."""
    data = bytes.fromhex("6F636552800000000001DF503B5BFFFF") + bytes(112)
    assert RecordedFile.parsed(2, data, 3) == RecordedFile(2, RECORD_UTC_S, 684_000)
    with pytest.raises(DotMessageError):
        RecordedFile.parsed(1, b"\1" + data[1:])
    with pytest.raises(DotMessageError):
        RecordedFile.parsed(1, data[:15])
