"""The workers of a dask cluster as an executor. Needs the extra `cluster`."""

from __future__ import annotations

import re
from collections.abc import Iterator
from concurrent.futures import CancelledError, Executor
from contextlib import contextmanager

from driftproof.support.environment import require_package

ADDRESS = re.compile(r"(\w+://)?[^/\s]+:\d+")
# Seconds in which a scheduler has to answer.
PATIENCE = 10


@contextmanager
def cluster_executor(address: str) -> Iterator[Executor]:
    """An executor on the cluster whose scheduler is at `address`, such as tcp://10.0.0.1:8786, while the block lasts.

    Its workers need driftproof installed in the same version. Work of one that is lost is given to others. Raises
    ValueError without the extra and for an address that is none, OSError where there is no scheduler, where it goes
    away, and where a task has taken several workers with it.
    """
    if not ADDRESS.fullmatch(address):
        raise ValueError(f"{address!r} is no address of a scheduler; write it like tcp://10.0.0.1:8786")
    require_package("distributed", "cluster", "a cluster needs distributed")
    from distributed import Client, KilledWorker

    with Client(address, timeout=PATIENCE, set_as_default=False) as client:
        try:
            yield client.get_executor(pure=False)
        except KilledWorker as error:
            raise ChildProcessError(f"the workers at {address} died of a batch: {error}") from None
        except CancelledError:
            raise ConnectionError(f"the cluster at {address} has gone away") from None
