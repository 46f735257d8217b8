"""Whether the service is alive."""

from fastapi import APIRouter

ROUTER = APIRouter(tags=["operations"])


@ROUTER.get("/healthz")
async def healthz() -> dict[str, str]:
    """The process runs and its event loop turns."""
    return {"status": "ok"}
