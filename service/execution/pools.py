"""Choice of the executor of long work: a Dask cluster, or processes of this machine."""

from service.execution.executors import Pools, processes


def pools_of(cluster: str) -> Pools:
    """Executors of a cluster by its address, or of processes where it is empty.

    Raises
    ------
    StepNcError
        If the address is not usable; whether the cluster answers is seen later.
    """
    if not cluster:
        return processes
    from service.execution.cluster import cluster_pools  # noqa: PLC0415 (Dask takes a second)

    return cluster_pools(cluster)
