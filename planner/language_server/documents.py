"""Which domain belongs to which problem, among open documents and files beside them."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

from planner import _core

FILES_SEARCHED = 500
"""Files of a folder looked at for a domain or problems."""
LARGEST_FILE_BYTES = 2_000_000


@lru_cache(maxsize=2 * FILES_SEARCHED)
def _definition(text: str) -> tuple[str, str, str | None] | None:
    return _core.definition_of(text)


@lru_cache(maxsize=2 * FILES_SEARCHED)
def _content(path: Path, modified_ns: int, size: int) -> str:  # noqa: ARG001 the key of the cache
    return path.read_text(encoding="utf-8", errors="replace")


@dataclass(frozen=True)
class Document:
    """A PDDL text."""

    path: Path
    text: str

    @property
    def definition(self) -> tuple[str, str, str | None] | None:
        """`domain` or `problem`, its name, and for a problem the name of its domain."""
        return _definition(self.text)

    @property
    def kind(self) -> str | None:
        """`domain`, `problem` or None."""
        return None if self.definition is None else self.definition[0]


@dataclass(frozen=True)
class Family:
    """A domain with problems of it."""

    domain: Document | None
    problems: tuple[Document, ...]

    @property
    def documents(self) -> tuple[Document, ...]:
        """The domain, then the problems."""
        return (() if self.domain is None else (self.domain,)) + self.problems


def family(document: Document, opened: Mapping[Path, str]) -> Family:
    """The domain and the problems that belong together with a document.

    A problem's domain is the nearest one of the right name: open documents first, then the folder
    of the problem, its subfolders and the folder above. Problems of a domain are searched likewise.
    """
    definition = document.definition
    if definition is None:
        return Family(None, (document,))
    kind, name, domain_name = definition
    if kind == "domain":
        problems = [
            other
            for other in _nearby(document.path, opened)
            if other.definition is not None
            and other.definition[0] == "problem"
            and other.definition[2] == name
        ]
        return Family(document, tuple(problems))
    domain = next(_domains(document, domain_name, opened), None)
    if domain is None:
        return Family(None, (document,))
    siblings = [other for other in family(domain, opened).problems if other.path != document.path]
    return Family(domain, (document, *siblings))


def _domains(problem: Document, name: str | None, opened: Mapping[Path, str]) -> Iterator[Document]:
    """Domains of a name, the nearest first."""
    for other in sorted(_nearby(problem.path, opened), key=lambda one: _distance(problem, one)):
        if other.definition is not None and other.definition[:2] == ("domain", name):
            yield other


def _distance(problem: Document, other: Document) -> tuple[int, str]:
    same_folder = other.path.parent == problem.path.parent
    return (0 if same_folder else 1, str(other.path))


def _nearby(path: Path, opened: Mapping[Path, str]) -> Iterator[Document]:
    """Open documents, then the files of the folder, the folders in it and the folder above."""
    for other, text in opened.items():
        yield Document(other, text)
    folder = path.parent
    patterns = [(folder, "*.pddl"), (folder, "*/*.pddl"), (folder.parent, "*.pddl")]
    count = 0
    for base, pattern in patterns:
        for other in sorted(base.glob(pattern)):
            count += 1
            if count > FILES_SEARCHED:
                return
            if other in opened:
                continue
            try:
                status = other.stat()
                if status.st_size <= LARGEST_FILE_BYTES:
                    text = _content(other, status.st_mtime_ns, status.st_size)
                    yield Document(other, text)
            except OSError:
                continue
