"""Pictures of a decision."""

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from scenarios.benchmarks.segments.pictures import draw_pictures
from scenarios.exploration.buildings import generated


def test_five_pictures_of_the_known_part(tmp_path: Path) -> None:
    paths = draw_pictures(generated("small_rooms", 1), 4, 30.0, tmp_path)
    assert len(paths) == 5
    sizes = set()
    for path in paths:
        with Image.open(path) as image:
            sizes.add(image.size)
            assert len(np.unique(np.asarray(image).reshape(-1, 3), axis=0)) > 3
    assert len(sizes) == 1


def test_a_time_after_the_end_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="explored before"):
        draw_pictures(generated("small_rooms", 1), 6, 1e5, tmp_path)
