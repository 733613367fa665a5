"""Storage of the token buckets that the web processes of several hosts share."""

from service.errors import TooMany
from service.storage.connection import Database


def take(database: Database, client: str, *, most: int, rate: float, burst: int) -> int:
    """Take tokens out of the bucket of a client, and return how many: 1 to ``most``.

    Parameters
    ----------
    database : Database
        A database on a server, whose clock fills the buckets.
    most : int
    rate : float
        Tokens per second that flow in.
    burst : int
        Tokens of a full bucket.

    Raises
    ------
    TooMany
        When there is none; carries the time until there is one.
    Unavailable
        When the database does not answer.
    """
    with database.writing() as connection:
        # The row is locked until the tokens are taken.
        row = connection.execute(
            "INSERT INTO rates AS old VALUES (?, ?, wall_clock()) "
            "ON CONFLICT (client) DO UPDATE SET seen = excluded.seen, tokens = "
            "least(?, old.tokens + ? * greatest(excluded.seen - old.seen, 0)) "
            "RETURNING tokens",
            (client, float(burst), float(burst), rate),
        ).fetchone()
        taken = min(int(row["tokens"]), most)
        if taken:
            connection.execute(
                "UPDATE rates SET tokens = tokens - ? WHERE client = ?", (taken, client)
            )
    if not taken:
        raise TooMany((1.0 - row["tokens"]) / rate)
    return taken


def sweep(database: Database, *, unused: float) -> None:
    """Delete buckets that were not used for a time, in s, after which they are full again."""
    with database.writing() as connection:
        connection.execute("DELETE FROM rates WHERE seen < wall_clock() - ?", (unused,))
