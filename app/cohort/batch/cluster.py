"""The workers of a Dask cluster, for the tasks of a batch. Imported where a batch names one: Dask may be missing."""

import logging
from collections.abc import Iterator
from contextlib import contextmanager
from time import monotonic
from typing import Any

from distributed import CancelledError, Client
from distributed.comm.core import CommClosedError
from distributed.scheduler import KilledWorker

from app.cohort.batch.software import software
from app.cohort.batch.spread import ClusterLostError, WorkerLostError, Workers
from devices.files.refusal import FileRefusedError, one_line

TRIES_OF_CLUSTER = 2  # each of them up to four of the cluster's own (`distributed.scheduler.allowed-failures`)
ANSWER_S = 10.0  # until a cluster's scheduler answers
FIRST_WORKER_S = 60.0  # until one of its workers does, which may have to be started for it
NOBODY_S = 300.0  # without any worker, after which nobody waits for one
COUNTED_S = 5.0  # how long the number of a cluster's workers is believed


@contextmanager
def of_a_cluster(address: str) -> Iterator[Workers]:
    """The workers of the Dask cluster whose scheduler has this address.

    Raises
    ------
    FileRefusedError
        The address or no worker answers, or the workers have another Gaitwright.
    """
    logging.getLogger("distributed").setLevel(logging.CRITICAL)  # what is lost we say ourselves, in our own words
    try:
        client = Client(address, timeout=ANSWER_S, set_as_default=False)
    except (OSError, ValueError, TypeError, RuntimeError) as problem:
        what = "no scheduler of Dask answers at this address"
        remedy = "Start the cluster, or give the address that its scheduler prints, such as tcp://192.0.2.1:8786"
        raise FileRefusedError(one_line(address), what, remedy) from problem
    try:
        _check_workers(client, address)
        executor = client.get_executor(pure=False)
        yield Workers(executor, ClusterSize(client), TRIES_OF_CLUSTER, translate=_translated)
    finally:
        client.close(timeout=ANSWER_S)


class ClusterSize:
    """The number of threads of a cluster's workers, asked for now and then: workers come and go."""

    def __init__(self, client: Any) -> None:
        self._client, self._count = client, 1
        self._asked_s = self._seen_s = monotonic() - COUNTED_S

    def __call__(self) -> int:
        """Give at least 1, since workers may come back; raises ClusterLostError if there was none for long."""
        now_s = monotonic()
        if now_s - self._asked_s >= COUNTED_S:
            count = sum(self._client.nthreads().values())
            self._asked_s = now_s
            self._seen_s = now_s if count else self._seen_s
            self._count = max(1, count)
            if now_s - self._seen_s > NOBODY_S:
                raise ClusterLostError("it has no worker any more")
        return self._count


def _check_workers(client: Any, address: str) -> None:
    asked = client.submit(software, pure=False)
    try:
        theirs = asked.result(timeout=FIRST_WORKER_S)
    except TimeoutError as problem:
        what = "no worker of this cluster answers"
        raise FileRefusedError(one_line(address), what, "Start workers, then run the command again") from problem
    except (ImportError, AttributeError) as problem:
        what = "the workers of this cluster have no Gaitwright, or an older one"
        raise FileRefusedError(one_line(address), what, "Install this version on all computers") from problem
    if theirs != software():
        what = "the workers of this cluster have another version of Gaitwright"
        raise FileRefusedError(one_line(address), what, "Install this version on all computers")


def _translated(error: Exception) -> Exception:
    if isinstance(error, KilledWorker):
        return WorkerLostError("its workers were killed again and again")
    if isinstance(error, CancelledError | CommClosedError):
        return ClusterLostError("the scheduler is gone")
    return error
