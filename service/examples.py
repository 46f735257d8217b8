"""Examples of bodies, by message: shown in the OpenAPI document, and tried out in the tests."""

from typing import Any

_HALL = "eNpLSUECDHBAHBsJAADIlwyB"
_ERRANDS = (
    "(define (domain errands)\n  (:requirements :typing :durative-actions)\n"
    "  (:types robot place)\n  (:predicates (at ?r - robot ?p - place))\n"
    "  (:durative-action go\n    :parameters (?r - robot ?a ?b - place)\n"
    "    :duration (= ?duration 5)\n    :condition (at start (at ?r ?a))\n"
    "    :effect (and (at start (not (at ?r ?a))) (at end (at ?r ?b)))))\n"
)
_ERRAND = (
    "(define (problem one) (:domain errands)\n  (:objects r - robot a b - place)\n"
    "  (:init (at r a))\n  (:goal (at r b)))\n"
)
_MAP = {
    "resolution_m": 1.0,
    "origin_m": [0.0, 0.0],
    "width": 12,
    "height": 6,
    "cells": _HALL,
}

EXAMPLES: dict[str, Any] = {
    "MissionRequest": {
        "name": "a hall",
        "domain": "disaster",
        "strategy": "planner",
        "map": _MAP,
        "robot_types": {"explorer": {"radius_m": 0.3, "speed_m_s": 1.0}},
        "robots": [{"id": "explorer_1", "type": "explorer", "pose": [2.5, 2.5, 0.0]}],
        "targets": [{"id": "target_1", "position_m": [9.5, 3.5]}],
    },
    "Report": {
        "sequence": 0,
        "time_s": 0.0,
        "robots": [{"id": "explorer_1", "pose": [2.5, 2.5, 0.0], "state": "idle"}],
    },
    "RobotMessage": {"id": "explorer_2", "type": "explorer", "pose": [3.5, 2.5, 0.0]},
    "TargetMessage": {"id": "target_2", "position_m": [5.5, 1.5]},
    "InstructionBody": {"kind": "deadline", "target": "target_1", "time_s": 60.0},
    "PlanSubmission": {"domain_text": _ERRANDS, "problem": _ERRAND, "time_limit_s": 1.0},
    "DomainUpload": {"text": _ERRANDS},
    "MapMessage": _MAP,
    "SolveBody": {"domain": _ERRANDS, "problem": _ERRAND},
    "PackageSolveBody": {"domain": _ERRANDS, "problem": _ERRAND, "time_limit": 1, "seed": 0},
    "RequestBody": {
        "domain": {"name": "errands", "format": "PDDL", "content": _ERRANDS},
        "problem": {"name": "one", "format": "PDDL", "content": _ERRAND},
        "configuration": {"planFormat": "JSON", "timeout": 1},
    },
    "ParseBody": {"domain": _ERRANDS, "problems": [_ERRAND]},
    "ValidateBody": {"domain": _ERRANDS, "problem": _ERRAND, "plan": "0.000: (go r a b) [5.000]\n"},
    "CheckBody": {"adaptor": "planning_editor_adaptor"},
}
