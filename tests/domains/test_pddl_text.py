from domains.naming import Names
from domains.pddl_text import ProblemText


def test_a_problem_reads_as_pddl() -> None:
    text = ProblemText(name="p", domain="d", names=Names(["A", "b"]))
    text.add_object("A", "robot")
    text.add_object("b", "place")
    text.fact("at", "A", "b")
    text.fluent("x", "b", value=1 / 3)
    text.timed_fact(2.5, "free", "A")
    text.goal("seen", "b")
    assert text.render() == (
        "(define (problem p)\n  (:domain d)\n"
        "  (:objects\n    b - place\n    a - robot)\n"
        "  (:init\n    (at a b)\n    (= (x b) 0.333333333333)\n    (at 2.500 (free a)))\n"
        "  (:goal (and\n    (seen b)))\n"
        "  (:metric minimize (total-time)))\n"
    )
