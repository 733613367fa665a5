BEGIN TRANSACTION;
CREATE TABLE jobs (
        id TEXT PRIMARY KEY, kind TEXT NOT NULL, state TEXT NOT NULL, request TEXT NOT NULL,
        program TEXT NOT NULL, source TEXT NOT NULL, owner TEXT NOT NULL,
        created REAL NOT NULL, started REAL, ended REAL,
        share REAL NOT NULL DEFAULT 0, message TEXT NOT NULL DEFAULT '', problem TEXT,
        attempt INTEGER NOT NULL DEFAULT 0, is_cancelling INTEGER NOT NULL DEFAULT 0
    ) STRICT;
INSERT INTO "jobs" VALUES('01m84kyjqpvews0437yf0qjhc4','advice','queued','{"mode": "QC", "machine": "vmc15", "material": "c45", "units": "iso", "roughness_um": 3.2, "free": ["feed"], "workingsteps": ["ROUGH THE FACE"], "profile": "optimisation", "nc_control": "linuxcnc", "has_pareto": true, "tool_change_s": 30.0, "has_corrections": true, "is_confirmed": true, "stock": "0,0,0,18,300,3", "safety": 0.8, "centre_cutting": {"MILL 18MM": true}, "allow_plunge": true}','01m84kyjqbaxb9qmktfj28d7zr','','anna',1780000001.25,NULL,NULL,0.0,'',NULL,0,0);
INSERT INTO "jobs" VALUES('01m84kyjqr2b1wn8qafbhc5r6f','advice','queued','{"mode": "TC", "machine": "vmc15", "material": "c45", "units": "iso", "roughness_um": null, "free": ["feed", "depth"], "workingsteps": [], "profile": "optimisation", "nc_control": "", "has_pareto": false, "tool_change_s": 0.0, "has_corrections": true, "safety": 0.9}','01m84kyjqbaxb9qmktfj28d7zr','','anna',1780000002.25,NULL,NULL,0.0,'',NULL,0,0);
INSERT INTO "jobs" VALUES('01m84kyjqsj7cbe8esvq8vpj5f','simulation','queued','{"program_id": null, "advice_id": "01m84kyjqpvews0437yf0qjhc4", "machine": "vmc15", "material": "c45", "units": "iso", "seed": 7, "pace": 0.0, "rate_hz": 50.0, "control": "exact-stop", "noise": "normal", "has_lag": true, "has_wear": true, "kc_factor": 1.2}','01m84kyjqbaxb9qmktfj28d7zr','01m84kyjqpvews0437yf0qjhc4','anna',1780000003.25,NULL,NULL,0.0,'',NULL,0,0);
INSERT INTO "jobs" VALUES('01m84kyjqt8ta250bf5cf3t592','control-run','queued','{"program_id": "01m84kyjqbaxb9qmktfj28d7zr", "advice_id": null, "machine": "vmc15", "material": "c45", "units": "iso", "seed": 3, "pace": 2.0, "mode": "QC", "law": "mpc", "has_preview": true, "look_ahead": 6, "disturbances": ["kc:1.3", "power:-50%@12s"], "force_set_point_n": 500.0, "override_low_percent": 30.0, "override_high_percent": 150.0, "sensor": "power", "has_corrections": false, "is_recorded": false}','01m84kyjqbaxb9qmktfj28d7zr','','anna',1780000004.25,NULL,NULL,0.0,'',NULL,0,0);
INSERT INTO "jobs" VALUES('01m84kyjqtys87jsegrxnhsk4b','trial','queued','{"inputs": {"milling_type": "up", "mode": "QC", "is_on": false, "teeth": 2, "axial_depth_mm": 1.5}, "seed": 5, "pace": 4.0}','','','anna',1780000005.25,NULL,NULL,0.0,'',NULL,0,0);
INSERT INTO "jobs" VALUES('01m84kyjqy4y33wyyzhr4w2rjd','evaluation','queued','{"machine": "vmc15", "material": null, "tool": null, "feature_kind": null, "program": null, "run": null, "since": "2026-01-05T06:00:00Z", "until": null, "grouping": "kind", "only": "factor pending", "sort": "time to win"}','','','anna',1780000006.25,NULL,NULL,0.0,'',NULL,0,0);
INSERT INTO "jobs" VALUES('01m84kyjr246f1wcj1dgy8dycc','review','queued','{"machine": null, "material": "c45", "tool": null, "feature_kind": null, "program": null, "run": null, "since": null, "until": "2026-06-01T00:00:00Z"}','','','anna',1780000007.25,NULL,NULL,0.0,'',NULL,0,0);
INSERT INTO "jobs" VALUES('01m84kyjr463g6pdce8a6q0vps','simulation','failed','{"program_id": "01m84kyjqbaxb9qmktfj28d7zr", "advice_id": null, "machine": "", "material": "", "units": "iso", "seed": 0, "pace": 0.0, "rate_hz": 20.0, "control": "fir", "noise": "none", "has_lag": false, "has_wear": false, "kc_factor": 1.0}','01m84kyjqbaxb9qmktfj28d7zr','','anna',1780000008.25,1780000100.5,1780000200.5,0.0,'','{"type": "urn:stepnc:problem:job-lost", "title": "Job lost", "status": 500, "detail": "the process that ran it has ended: 3 attempts"}',0,0);
CREATE TABLE keys (
        id TEXT PRIMARY KEY, hash TEXT NOT NULL, name TEXT NOT NULL, roles TEXT NOT NULL,
        created REAL NOT NULL, revoked REAL
    ) STRICT;
CREATE TABLE programs (
        id TEXT PRIMARY KEY, name TEXT NOT NULL, size INTEGER NOT NULL, sha256 TEXT NOT NULL,
        owner TEXT NOT NULL, created REAL NOT NULL
    ) STRICT;
INSERT INTO "programs" VALUES('01m84kyjqbaxb9qmktfj28d7zr','paper002.stpnc',3380,'cb2118ed57de02746cb61906cf17ce097dd0db2b59360074dc707a643b03aad0','anna',1.79545147261944150929e+09);
CREATE TABLE requests (
        owner TEXT NOT NULL, key TEXT NOT NULL, fingerprint TEXT NOT NULL,
        made TEXT NOT NULL, created REAL NOT NULL, PRIMARY KEY (owner, key)
    ) STRICT;
CREATE TABLE runner (
        id INTEGER PRIMARY KEY CHECK (id = 1), pid INTEGER NOT NULL, seen REAL NOT NULL
    ) STRICT;
CREATE INDEX jobs_by_state ON jobs (state, id);
CREATE INDEX jobs_by_kind ON jobs (kind, id);
CREATE INDEX jobs_by_program ON jobs (program, id);
COMMIT;
PRAGMA user_version=1;
