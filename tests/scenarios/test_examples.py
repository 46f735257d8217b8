from pathlib import Path

from scenarios import examples


def test_the_examples_in_the_domains_are_what_the_script_writes(tmp_path: Path) -> None:
    for path in examples.write(tmp_path):
        kept = examples.ROOT / path.relative_to(tmp_path)
        assert path.read_text(encoding="utf-8") == kept.read_text(encoding="utf-8")
