"""Films of a small mission: frames, colours, what is refused."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from scenarios.composition import Composition
from scenarios.mission_record import MissionRecord
from scenarios.report import movie
from scenarios.report.movie import BLOCKADE, ROBOTS, MovieError, MovieSettings, write_movie

SETTINGS = MovieSettings(width_px=301, frames_per_s=5, speed=10.0)


def colours(picture: Image.Image) -> set[tuple[int, ...]]:
    return {tuple(pixel) for pixel in np.asarray(picture.convert("RGB")).reshape(-1, 3).tolist()}


def test_a_gif_shows_the_mission_from_start_to_end(
    record: MissionRecord, composition: Composition, tmp_path: Path
) -> None:
    path = write_movie(tmp_path / "m.gif", record, composition, SETTINGS)
    with Image.open(path) as film:
        assert film.n_frames > 1
        assert film.size[0] % 2 == film.size[1] % 2 == 0
        film.seek(film.n_frames - 1)
        last = colours(film)
    assert set(ROBOTS[: len(record.robots)]) <= last


def test_a_blockade_is_orange_only_while_it_is_known_and_stands(
    record: MissionRecord, composition: Composition, tmp_path: Path
) -> None:
    (first, *_) = record.blockades
    seen = replace(first, seen_at_s=2.0, cleared_at_s=4.0, cleared_by=None)
    record = replace(record, blockades=(seen,), robots=(), targets=(), duration_s=6.0)
    settings = replace(SETTINGS, frames_per_s=1, speed=1.0)
    path = write_movie(tmp_path / "m.gif", record, composition, settings)
    with Image.open(path) as film:
        shown = []
        for second in (1, 3, 5):
            film.seek(second)
            shown.append(BLOCKADE in colours(film))
    assert shown == [False, True, False]


def test_other_endings_are_refused_before_a_mission_is_run() -> None:
    with pytest.raises(MovieError, match=r"\.gif or \.mp4"):
        movie.require_writable(Path("m.avi"))


def test_a_missing_encoder_is_named(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(MovieError, match="ffmpeg"):
        movie.require_writable(Path("m.mp4"))


def test_positions_between_samples(record: MissionRecord) -> None:
    robot = replace(record.robots[0], trail=((0.0, 0.0, 0.0), (2.0, 4.0, -2.0)))
    assert movie.position(robot, 1.0) == (2.0, -1.0)


def test_composition_is_drawn_the_right_way_up(
    record: MissionRecord, composition: Composition, tmp_path: Path
) -> None:
    cells = np.zeros((40, 40), dtype=np.int8)
    cells[:4] = 100  # the southern wall
    composition = replace(composition, cells=cells, resolution_m=0.1, origin_m=(0.0, 0.0))
    record = replace(record, blockades=(), robots=(), targets=(), duration_s=1.0)
    path = write_movie(tmp_path / "m.gif", record, composition, replace(SETTINGS, width_px=200))
    with Image.open(path) as film:
        picture = np.asarray(film.convert("RGB"))
    # Pillow matches colours to the palette to a few bits only.
    np.testing.assert_allclose(picture[-5, 100], movie.WALL, atol=8)
    np.testing.assert_allclose(picture[60, 100], movie.FLOOR, atol=8)
