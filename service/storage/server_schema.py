"""Tables of the service on a PostgreSQL server: those of the SQLite file, with its names.

Ids are compared by their bytes, as SQLite does, because pages are cut by them. Indexes of
waiting jobs hold only those, however many have ended. An entry that was released never changes.
"""

SPACE = "stepnc_service"
"""Schema of the tables in the database, apart from the knowledge base's."""

PACED = (
    "(kind IN ('control-run', 'trial') OR (kind IN ('simulation', 'factory') "
    "AND CAST(coalesce(json_extract(request, '$.pace'), '0') AS REAL) > 0))"
)
"""Condition of the indexes of version 1: that of claims, or they are not used."""

SCHEMA: tuple[tuple[str, ...], ...] = (
    (
        "CREATE FUNCTION wall_clock() RETURNS DOUBLE PRECISION LANGUAGE sql VOLATILE "
        "AS $$ SELECT extract(epoch FROM clock_timestamp())::DOUBLE PRECISION $$",
        "CREATE FUNCTION json_extract(document TEXT, path TEXT) RETURNS TEXT LANGUAGE sql "
        "IMMUTABLE AS $$ SELECT document::json ->> substr(path, 3) $$",
        """
        CREATE TABLE programs (
            id TEXT COLLATE "C" PRIMARY KEY, name TEXT NOT NULL, size BIGINT NOT NULL,
            sha256 TEXT NOT NULL, owner TEXT NOT NULL, created DOUBLE PRECISION NOT NULL
        )
        """,
        """
        CREATE TABLE jobs (
            id TEXT COLLATE "C" PRIMARY KEY, kind TEXT NOT NULL, state TEXT NOT NULL,
            request TEXT NOT NULL, program TEXT NOT NULL, source TEXT NOT NULL,
            owner TEXT NOT NULL, created DOUBLE PRECISION NOT NULL, started DOUBLE PRECISION,
            ended DOUBLE PRECISION, share DOUBLE PRECISION NOT NULL DEFAULT 0,
            message TEXT NOT NULL DEFAULT '', problem TEXT, attempt BIGINT NOT NULL DEFAULT 0,
            is_cancelling BIGINT NOT NULL DEFAULT 0, runner TEXT NOT NULL DEFAULT '',
            rowid BIGINT GENERATED ALWAYS AS IDENTITY
        )
        """,
        "CREATE INDEX jobs_by_state ON jobs (state, id)",
        "CREATE INDEX jobs_by_kind ON jobs (kind, id)",
        "CREATE INDEX jobs_by_program ON jobs (program, id)",
        f"CREATE INDEX jobs_waiting ON jobs (rowid) WHERE state = 'queued' AND NOT {PACED}",
        f"CREATE INDEX jobs_waiting_paced ON jobs (rowid) WHERE state = 'queued' AND {PACED}",
        "CREATE INDEX jobs_running ON jobs (runner) WHERE state = 'running'",
        """
        CREATE TABLE requests (
            owner TEXT NOT NULL, key TEXT NOT NULL, fingerprint TEXT NOT NULL,
            made TEXT NOT NULL, created DOUBLE PRECISION NOT NULL, PRIMARY KEY (owner, key)
        )
        """,
        "CREATE INDEX requests_by_age ON requests (created)",
        """
        CREATE TABLE keys (
            id TEXT COLLATE "C" PRIMARY KEY, hash TEXT NOT NULL, name TEXT NOT NULL,
            roles TEXT NOT NULL, created DOUBLE PRECISION NOT NULL, revoked DOUBLE PRECISION
        )
        """,
        """
        CREATE TABLE runner (
            id TEXT PRIMARY KEY, pid BIGINT NOT NULL, seen DOUBLE PRECISION NOT NULL
        )
        """,
        """
        CREATE TABLE files (
            id TEXT COLLATE "C" PRIMARY KEY, kind TEXT NOT NULL, name TEXT NOT NULL,
            size BIGINT NOT NULL, sha256 TEXT NOT NULL, owner TEXT NOT NULL,
            created DOUBLE PRECISION NOT NULL
        )
        """,
        "CREATE INDEX files_by_kind ON files (kind, id)",
        # Buckets of the rate limit; after a crash of the server all are full.
        """
        CREATE UNLOGGED TABLE rates (
            client TEXT PRIMARY KEY, tokens DOUBLE PRECISION NOT NULL,
            seen DOUBLE PRECISION NOT NULL
        )
        """,
        # Identity of the folder of files, which all hosts must share.
        "CREATE TABLE folder (id TEXT NOT NULL)",
    ),
    # Programs of earlier versions are STEP-NC programs.
    ("ALTER TABLE programs ADD COLUMN kind TEXT NOT NULL DEFAULT 'step-nc'",),
    ("ALTER TABLE jobs ADD COLUMN key TEXT NOT NULL DEFAULT ''",),
)
"""Migration statements of each version; the version is the number of entries applied."""
