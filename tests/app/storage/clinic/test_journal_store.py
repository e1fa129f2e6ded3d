"""Journals in a place that all stations reach, a folder or an S3 bucket: whole under their hash, or not there."""

import hashlib
import logging
import os
from collections.abc import Iterator
from pathlib import Path

import fsspec
import pytest

from app.storage.clinic.journal_store import JournalStore
from app.storage.stored import LibraryError

CONTENT = bytes(range(256)) * 9000  # more than two pieces
SHA256 = hashlib.sha256(CONTENT).hexdigest()


@pytest.fixture(scope="session")
def s3_address() -> Iterator[str]:
    """An S3 of the test run's own: no package registry has MinIO."""
    server_of = pytest.importorskip("moto.server", reason="moto is not installed")
    logging.getLogger("werkzeug").setLevel(logging.ERROR)
    server = server_of.ThreadedMotoServer(ip_address="127.0.0.1", port=0, verbose=False)
    server.start()
    host, port = server.get_host_and_port()
    yield f"http://{host}:{port}"
    server.stop()


@pytest.fixture(params=["folder", pytest.param("s3", marks=pytest.mark.endurance)])
def place(request: pytest.FixtureRequest, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    if request.param == "folder":
        (tmp_path / "place").mkdir()
        return str(tmp_path / "place")
    monkeypatch.setenv("AWS_ENDPOINT_URL", request.getfixturevalue("s3_address"))
    for name in ("AWS_ACCESS_KEY_ID", "AWS_SECRET_ACCESS_KEY"):
        monkeypatch.setenv(name, "testing")
    monkeypatch.setenv("AWS_DEFAULT_REGION", "us-east-1")
    import s3fs

    bucket = hashlib.sha256(str(tmp_path).encode()).hexdigest()[:20]
    s3fs.S3FileSystem(endpoint_url=request.getfixturevalue("s3_address")).mkdir(bucket)
    return f"s3://{bucket}/journals"


def names_in(place: str) -> set[str]:
    """What another program sees there."""
    options = {"endpoint_url": os.environ["AWS_ENDPOINT_URL"]} if place.startswith("s3:") else {}
    files, root = fsspec.core.url_to_fs(place, **options)
    files.invalidate_cache()
    return {path.rpartition("/")[2] for path in files.find(root)}


@pytest.fixture
def journal(tmp_path: Path) -> Path:
    path = tmp_path / "a.journal"
    path.write_bytes(CONTENT)
    return path


def test_what_is_put_is_fetched_as_it_was(place: str, journal: Path, tmp_path: Path) -> None:
    store = JournalStore(place)
    assert names_in(place) == set()
    name = store.put(journal)
    assert name == f"{SHA256}.journal"
    assert store.put(journal) == name  # again
    assert names_in(place) == {name}
    store.fetch(name, tmp_path / "copies" / "b.journal")
    assert (tmp_path / "copies" / "b.journal").read_bytes() == CONTENT
    store.destroy(name)
    store.destroy(name)
    assert names_in(place) == set()
    with pytest.raises(LibraryError, match="A recording is missing from the clinic's shared storage"):
        store.fetch(name, tmp_path / "copies" / "c.journal")
    assert [path.name for path in (tmp_path / "copies").iterdir()] == ["b.journal"]


def test_a_place_that_is_not_there_takes_nothing(place: str, journal: Path) -> None:
    with pytest.raises(LibraryError, match="is not there"):
        JournalStore(place.removesuffix("/journals") + "-of-another").put(journal)


@pytest.mark.endurance
def test_a_bucket_that_does_not_answer_is_stated_not_to(monkeypatch: pytest.MonkeyPatch, journal: Path) -> None:
    pytest.importorskip("s3fs")
    monkeypatch.setenv("AWS_ENDPOINT_URL", "http://127.0.0.1:9")
    monkeypatch.setenv("AWS_ACCESS_KEY_ID", "testing")
    monkeypatch.setenv("AWS_SECRET_ACCESS_KEY", "testing")
    with pytest.raises(LibraryError, match="does not respond"):
        JournalStore("s3://bucket").put(journal)


def test_a_place_that_lets_nobody_in_states_so(tmp_path: Path, journal: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "place").mkdir()
    store = JournalStore(str(tmp_path / "place"))

    def refused(*_: object, **__: object) -> None:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr("app.storage.clinic.journal_store.os.open", refused)
    with pytest.raises(LibraryError, match="This workstation has no access to the clinic's shared storage"):
        store.put(journal)


def test_half_a_journal_has_no_journals_name(tmp_path: Path, journal: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "place").mkdir()
    store = JournalStore(str(tmp_path / "place"))

    def killed(*_: object) -> None:
        raise KeyboardInterrupt

    with monkeypatch.context() as patched:
        patched.setattr("app.storage.clinic.journal_store.os.fsync", killed)
        with pytest.raises(KeyboardInterrupt):
            store.put(journal)
    assert not list((tmp_path / "place").glob("*.journal"))
    assert store.put(journal) == f"{SHA256}.journal"


@pytest.mark.parametrize("address", ["gopher://clinic.example/a", "unheard-of://b"])
def test_an_address_that_nothing_here_reads_is_refused(address: str) -> None:
    with pytest.raises(LibraryError, match="Recordings cannot be stored at this address"):
        JournalStore(address)


ELSEWHERE = (
    "http://127.0.0.1/x",
    "ftp://host/x",
    "github://a:b@/",
    "memory://x",
    "file:///tmp",
    "recordings",
    "",
)


@pytest.mark.parametrize("place", [*ELSEWHERE, "zip://x::/tmp/a.zip", "s3:bucket", "simplecache::s3://bucket/x"])
def test_a_place_is_a_folder_or_a_bucket_and_nothing_else(place: str) -> None:
    with pytest.raises(LibraryError, match="Recordings cannot be stored at this address"):
        JournalStore(place)
