"""A bare FastAPI application that answers with the same bytes: what the framework costs."""

import os
from pathlib import Path

from fastapi import FastAPI
from fastapi.responses import Response

BODY = Path(os.environ.get("STEPNC_BENCH_BODY", os.devnull)).read_bytes()

app = FastAPI()


@app.get("/v1/advice/{id}/workingsteps/{workingstep}")
async def advised(id: str, workingstep: str) -> Response:
    return Response(BODY, media_type="application/json")
