"""Keys report when they were made and nothing else, and sort by it."""

from app.storage.database.ids import uuid7


def test_a_key_is_a_uuid_of_version_7_that_holds_its_time() -> None:
    key = uuid7(1_645_557_742_000 * 1_000_000)  # RFC 9562, A.6
    assert key.version == 7
    assert key.variant == "specified in RFC 4122"
    assert str(key).startswith("017f22e2-79b0-7000-")


def test_keys_sort_by_their_time_to_a_microsecond_and_differ() -> None:
    keys = [uuid7(1_000_000_000_000_000_000 + 1_000 * k) for k in range(3000)]
    assert sorted(keys) == keys
    assert len({uuid7(0) for _ in range(3000)}) == 3000
