"""T17: with workers killed every few seconds a batch gives what it gives undisturbed, each once, with Dask too."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from app.cli.main import main
from app.cohort.batch import cluster
from app.cohort.batch.cluster import of_a_cluster
from app.cohort.batch.spread import ClusterLostError, finished
from devices.files.refusal import FileRefusedError
from tests.app.batch_material import results_in, write_swinging
from tests.app.batch_stand_ins import StandIn, digest_of
from tests.driver import Found
from tests.safety import batch_kills

pytestmark = [
    pytest.mark.endurance,
    # distributed's own, when it is ended amid its work: sockets and loops that it leaves to the collector
    pytest.mark.filterwarnings("ignore::ResourceWarning", "ignore::pytest.PytestUnraisableExceptionWarning"),
]


def test_stand_ins_are_equal_by_hash_and_each_is_done_once() -> None:
    found = Found()
    batch_kills.stand_ins(15_000, 5.0, 500, "serial,pool,dask", found)
    assert found.faults == [], found


def test_a_hundred_sessions_are_equal_by_hash_with_their_table(tmp_path: Path) -> None:
    found = Found()
    batch_kills.sessions(tmp_path, 100, 5.0, "serial,pool,dask", found)
    assert found.faults == [], found
    assert found.count["workers killed of 100 sessions, pool"] > 0


def test_the_command_gives_the_same_by_a_cluster_and_goes_on_there(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    write_swinging(tmp_path / "in", 4)
    bare = ["batch", str(tmp_path / "in"), "--no-report", "--no-rrd"]
    assert main([*bare, "--out", str(tmp_path / "one"), "--workers", "1"]) == 0
    with batch_kills.local_cluster() as cluster:
        by_dask = ["--out", str(tmp_path / "two"), "--dask", cluster.scheduler_address]
        assert main([*bare, *by_dask]) == 0
        assert results_in(tmp_path / "one") == results_in(tmp_path / "two")
        capsys.readouterr()
        assert main([*bare, *by_dask]) == 0
    assert "0 analysed, 4 were done before" in capsys.readouterr().out


def test_an_address_where_nothing_answers_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cluster, "ANSWER_S", 0.5)
    for address in ("tcp://127.0.0.1:1", "nonsense://127.0.0.1:1"):
        with pytest.raises(FileRefusedError, match="no scheduler of Dask answers"), of_a_cluster(address):
            pass


def test_a_cluster_that_ends_amid_the_work_ends_the_batch() -> None:
    with batch_kills.local_cluster() as cluster, of_a_cluster(cluster.scheduler_address) as workers:

        def given() -> Iterator[StandIn]:
            yield from (StandIn(number, rounds=1000) for number in range(2000))
            cluster.close()
            yield from (StandIn(number) for number in range(2000, 20_000))

        with pytest.raises(ClusterLostError):
            list(finished(digest_of, given(), workers))


class NoWorkers:
    """A client of a cluster that has a scheduler and nobody else."""

    def nthreads(self) -> dict[str, int]:
        return {}


def test_a_cluster_without_workers_is_waited_for_and_then_no_longer(monkeypatch: pytest.MonkeyPatch) -> None:
    counted = cluster.ClusterSize(NoWorkers())
    assert counted() == 1
    monkeypatch.setattr(cluster, "COUNTED_S", 0.0)
    monkeypatch.setattr(cluster, "NOBODY_S", 0.0)
    with pytest.raises(ClusterLostError, match="no worker any more"):
        counted()
