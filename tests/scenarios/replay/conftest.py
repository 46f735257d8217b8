"""A mission of a scripted fleet in a database, and what the service said of it in the end."""

import sys
from pathlib import Path
from typing import Any

import pytest

sys.path.insert(0, str(Path(__file__).parents[2] / "service"))

from in_process import serving
from test_mission_loop import ROOMS, TARGETS, drive, fleet

from service.app import create_app
from service.settings import Settings, sqlite_url


@pytest.fixture(scope="session")
def told(tmp_path_factory: pytest.TempPathFactory) -> tuple[str, dict[str, Any]]:
    """The database's URL, and the mission as the service showed it when it was completed."""
    url = sqlite_url(tmp_path_factory.mktemp("replay") / "missions.sqlite")
    with serving(create_app(Settings(database_url=url))) as client:
        where = client.post(
            "/v1/missions", json=fleet().mission(ROOMS, TARGETS, strategy="planner")
        ).headers["location"]
        assert drive(client, where, fleet()) == "completed"
        return url, client.get(where).json()
