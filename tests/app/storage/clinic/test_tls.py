"""A clinic's server in the network has to prove who it is, by a certificate of the clinic's own root.

The PostgreSQL of the tests knows no TLS, so something is before it that does: to what connects it is the server.
"""

import datetime
import ipaddress
import socket
import ssl
import struct
import threading
from collections.abc import Callable, Iterator
from contextlib import closing, suppress
from pathlib import Path
from urllib.parse import quote

import pytest
from cryptography import x509
from cryptography.hazmat.primitives import hashes, serialization
from cryptography.hazmat.primitives.asymmetric import ec
from cryptography.x509.oid import NameOID
from sqlalchemy import make_url, text

from app.storage.clinic.station import Station
from app.storage.stored import LibraryFaultError

pytestmark = pytest.mark.endurance  # each connects to a server

NAME = "server.clinic.example"
SSL_REQUEST, GSS_REQUEST = 80877103, 80877104
DAY = datetime.timedelta(days=1)
Key = ec.EllipticCurvePrivateKey


def certificate(name: str, key: Key, issuer: str, issuers_key: Key, *, is_root: bool) -> x509.Certificate:
    now = datetime.datetime.now(datetime.UTC)
    return (
        x509.CertificateBuilder()
        .subject_name(x509.Name([x509.NameAttribute(NameOID.COMMON_NAME, name)]))
        .issuer_name(x509.Name([x509.NameAttribute(NameOID.COMMON_NAME, issuer)]))
        .public_key(key.public_key())
        .serial_number(x509.random_serial_number())
        .not_valid_before(now - DAY)
        .not_valid_after(now + DAY)
        .add_extension(x509.BasicConstraints(ca=is_root, path_length=None), critical=True)
        .add_extension(
            x509.SubjectAlternativeName([x509.DNSName(name), x509.IPAddress(ipaddress.ip_address("127.0.0.9"))]),
            critical=False,
        )
        .sign(issuers_key, hashes.SHA256())
    )


def pem(one: x509.Certificate) -> bytes:
    return one.public_bytes(serialization.Encoding.PEM)


@pytest.fixture(scope="module")
def certificates(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The clinic's root, another root, and the server's certificate and key."""
    folder = tmp_path_factory.mktemp("certificates")
    root_key, other_key, key = (ec.generate_private_key(ec.SECP256R1()) for _ in range(3))
    for name, own in (("root", root_key), ("other", other_key)):
        (folder / f"{name}.pem").write_bytes(pem(certificate(name, own, name, own, is_root=True)))
    unsealed = serialization.NoEncryption()
    secret = key.private_bytes(serialization.Encoding.PEM, serialization.PrivateFormat.PKCS8, unsealed)
    (folder / "server.pem").write_bytes(secret + pem(certificate(NAME, key, "root", root_key, is_root=False)))
    return folder


class TlsFront:
    """Listens in the network of this computer, for a PostgreSQL that is at a socket."""

    def __init__(self, to: str, certificate: Path | None) -> None:
        self._to, self._context = to, None
        if certificate is not None:
            self._context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
            self._context.load_cert_chain(certificate)
        self._listening = socket.create_server(("127.0.0.1", 0))
        self.port: int = self._listening.getsockname()[1]
        self._open: list[socket.socket] = []
        threading.Thread(target=self._listen, daemon=True).start()

    def cut_off(self) -> None:
        """As when the server crashes: nobody states good-bye."""
        for one in self._open:
            with suppress(OSError):
                one.shutdown(socket.SHUT_RDWR)

    def close(self) -> None:
        self._listening.close()
        self.cut_off()

    def _listen(self) -> None:
        with suppress(OSError):
            while True:
                threading.Thread(target=self._serve, args=(self._listening.accept()[0],), daemon=True).start()

    def _serve(self, client: socket.socket) -> None:
        with suppress(OSError), closing(client):
            while (request := struct.unpack("!ii", client.recv(8))[1]) == GSS_REQUEST:
                client.sendall(b"N")
            assert request == SSL_REQUEST
            if self._context is None:
                client.sendall(b"N")
                client.recv(1)
                return
            client.sendall(b"S")
            with (
                socket.socket(socket.AF_UNIX) as server,
                self._context.wrap_socket(client, server_side=True) as secured,
            ):
                server.connect(self._to)
                self._open.append(secured)
                threading.Thread(target=pump, args=(server, secured), daemon=True).start()
                pump(secured, server)


def pump(source: socket.socket, target: socket.socket) -> None:
    with suppress(OSError):
        while data := source.recv(65536):
            target.sendall(data)
        target.shutdown(socket.SHUT_WR)


Connect = Callable[[str, str], Station]


@pytest.fixture
def front(request: pytest.FixtureRequest, database_url: str, certificates: Path) -> Iterator[TlsFront]:
    is_secured = getattr(request, "param", True)
    host = make_url(database_url).query["host"]
    front = TlsFront(f"{host}/.s.PGSQL.5432", certificates / "server.pem" if is_secured else None)
    yield front
    front.close()


@pytest.fixture
def connect(front: TlsFront, database_url: str, certificates: Path) -> Connect:
    """A station that calls the server `name`, and knows the root in `root`.pem."""

    def make(name: str, root: str) -> Station:
        database = make_url(database_url).database
        known = quote(str(certificates / f"{root}.pem"))
        address = f"postgresql://postgres@{name}:{front.port}/{database}?hostaddr=127.0.0.1&sslrootcert={known}"
        return Station("any", address)

    return make


def answer_of(station: Station) -> object:
    database = station.database_once()
    try:
        with database.reading() as session:
            return session.scalar(text("SELECT 42"))
    finally:
        database.close()


def test_the_right_name_with_the_right_root_is_let_in(connect: Connect) -> None:
    assert answer_of(connect(NAME, "root")) == 42


@pytest.mark.parametrize(("name", "root"), [(NAME, "other"), ("other.clinic.example", "root"), (NAME, "missing")])
def test_another_root_another_name_or_no_root_is_refused(connect: Connect, name: str, root: str) -> None:
    with pytest.raises(LibraryFaultError, match="could not prove who it is"):
        answer_of(connect(name, root))


@pytest.mark.parametrize("front", [False], indirect=True)
def test_a_server_without_tls_is_refused_over_the_network(connect: Connect) -> None:
    with pytest.raises(LibraryFaultError, match="could not prove who it is"):
        answer_of(connect(NAME, "root"))


def test_a_server_that_goes_away_amid_tls_is_not_stated_to_be_another(connect: Connect, front: TlsFront) -> None:
    database = connect(NAME, "root").database_kept()
    try:
        with pytest.raises(LibraryFaultError, match="does not respond"), database.reading() as session:  # noqa: PT012 - it is cut off amid it
            session.scalar(text("SELECT 42"))
            front.cut_off()
            session.scalar(text("SELECT 43"))
        with database.reading() as session:  # the connection that was lost is made again
            assert session.scalar(text("SELECT 44")) == 44
    finally:
        database.close()
