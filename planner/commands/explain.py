"""`marsupial explain`: what a diagnostic code says, why it matters, an example."""

import sys
from typing import Annotated

import typer

from planner import _core
from planner.commands.faults import told
from planner.reading import InputError

HEADER = """\
# Diagnostics

Every finding of `marsupial check`, the planner and the language server has a stable code.
`marsupial explain PDDL021` prints an entry of this page, which is generated from the same table
(`marsupial explain --markdown`).

An example with a line `;;; problem` is a domain and a problem; what follows a line `;;; plan`
is a plan.
"""


def explain(
    code: Annotated[
        str | None, typer.Argument(help="A code such as PDDL021; none lists all.")
    ] = None,
    markdown: Annotated[
        bool, typer.Option("--markdown", help="Print the page of all codes.")
    ] = False,
) -> None:
    """Explain a diagnostic code: what it says, why it matters, an example that gives it."""
    with told():
        if markdown:
            text = as_markdown()
        elif code is None:
            text = listing()
        else:
            text = explanation(code)
    sys.stdout.write(text)


def explanation(code: str) -> str:
    """The entry of one code; raises `InputError` for an unknown one."""
    known = _core.parse_code(code)
    for number, severity, title, what, why, example in _core.codes():
        if number == known:
            indented = "\n".join(f"    {line}" for line in example.splitlines())
            return f"{number}: {title} ({severity})\n\n{what}\n{why}\n\nExample:\n{indented}\n"
    raise InputError(f"there is no code {code!r}; `marsupial explain` lists all")


def listing() -> str:
    """One line for each code."""
    return "".join(
        f"{code}  {severity:11}  {title}\n" for code, severity, title, *_ in _core.codes()
    )


def as_markdown() -> str:
    """The page docs/diagnostics.md."""
    parts = [HEADER]
    for code, severity, title, what, why, example in _core.codes():
        parts.append(
            f"\n## {code}: {title}\n\n*{severity.capitalize()}.* {what}\n{why}\n\n"
            f"```lisp\n{example}\n```\n"
        )
    return "".join(parts)
