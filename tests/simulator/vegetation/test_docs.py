"""The program that docs/vegetation.md shows runs."""

import re
from pathlib import Path

from simulator.vegetation.vegetation_map import VegetationMap

PAGE = Path(__file__).parents[3] / "docs" / "vegetation.md"


def test_the_program_of_the_page_runs() -> None:
    (program,) = re.findall(r"^```python\n(.*?)^```", PAGE.read_text("utf-8"), re.M | re.S)
    names: dict[str, object] = {}
    exec(program, names)
    vegetation_map = names["vegetation_map"]
    assert isinstance(vegetation_map, VegetationMap)
    assert len(vegetation_map.surface()[0]) > 1000
