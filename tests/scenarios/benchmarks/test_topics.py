"""Every benchmark topic has a line of its own and the one function that runs it."""

import ast
from pathlib import Path

import pytest

from scenarios import benchmarks
from scenarios.benchmarks import topics

FOLDER = Path(benchmarks.__file__).parent


@pytest.mark.parametrize("name", sorted(topics()))
def test_topic_has_a_line_and_runs(name: str) -> None:
    assert topics()[name]
    module = FOLDER / f"{name}.py"
    source = module if module.is_file() else FOLDER / name / "__init__.py"
    tree = ast.parse(source.read_text(encoding="utf-8"))
    defined = {node.name: node for node in tree.body if isinstance(node, ast.FunctionDef)}
    imported = {
        alias.asname or alias.name
        for node in tree.body
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
    }
    assert "run" in defined or "run" in imported
    if "run" in defined:
        assert {"quick", "out"} <= {argument.arg for argument in defined["run"].args.kwonlyargs}


def test_topics_are_the_files_of_the_folder() -> None:
    files = {
        path.stem
        for path in FOLDER.iterdir()
        if not path.name.startswith("_")
        and (path.suffix == ".py" or (path / "__init__.py").is_file())
    }
    assert set(topics()) == files
