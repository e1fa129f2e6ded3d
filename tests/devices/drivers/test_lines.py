"""Lines of numbers are known as such, and what their columns may be is guessed by what they hold."""

import pytest

from devices.drivers.csv_serial import Columns
from devices.drivers.lines import columns_in, guessed, table_of


def lines(form: str, count: int = 20) -> list[str]:
    """Lines of a sensor that lies still: `{t}` counts milliseconds by ten."""
    return [form.format(t=10 * number, s=0.01 * number, us=10_000 * number) for number in range(count)]


def test_lines_of_numbers_are_reported_from_text_and_noise() -> None:
    stated = "\r\n".join(lines("{t},0.1,0.2,0.3,0,0,1")).encode()
    assert columns_in(stated) == 7
    assert columns_in(stated[3:]) == 7
    assert columns_in(b"time,gx,gy,gz,ax,ay,az\r\n" * 5) == 0
    assert columns_in(b"1,2,3\r\n" * 5) == 0
    assert columns_in(bytes(range(256)) * 20) == 0
    assert columns_in(b"nan,1,2,3,4,5,6\n" * 9) == 0
    assert columns_in(b"") == 0


@pytest.mark.parametrize(
    ("form", "expected"),
    [
        ("{t},0.1,0.2,-0.3,0.02,-0.98,0.1", Columns(0, (1, 2, 3), (4, 5, 6), count=7)),
        (
            "{us};0.3;9.7;0.6;0.1;0.2;0.3;24.5",
            Columns(0, (4, 5, 6), (1, 2, 3), 1e6, force_unit="m/s2", separator="semicolon", count=8),
        ),
        (
            "0.1 0.2 0.3 10 990 20 {s:.2f}",
            Columns(6, (0, 1, 2), (3, 4, 5), 1.0, force_unit="mg", separator="space", count=7),
        ),
    ],
)
def test_time_ascends_and_three_columns_hold_gravity(form: str, expected: Columns) -> None:
    assert guessed(lines(form)) == expected


def test_nothing_is_guessed_of_what_holds_no_gravity() -> None:
    assert guessed(lines("{t},5000,6000,7000,8000,9000,9999")) is None
    assert guessed(["no", "numbers"]) is None


def test_lines_that_were_cut_are_left_out() -> None:
    table, separator = table_of([*lines("{t}\t1\t2\t3\t4\t5\t6"), "7\t8", "x"])
    assert (table.shape, separator) == ((20, 7), "tab")
