"""The listener sees each plan once and changes nothing in the traffic."""

import httpx

from scenarios.plan_listener import PlanListener


def step(start_s: float) -> dict[str, object]:
    return {"start_s": start_s, "action": "explore", "arguments": ["e", "t"], "duration_s": 30.0}


class Service:
    """Answers like the service; each report's answer carries the next revision of `revisions`."""

    def __init__(self, revisions: list[int]) -> None:
        self.revisions = iter(revisions)
        self.revision = -1
        self.asked: list[str] = []

    def __call__(self, request: httpx.Request) -> httpx.Response:
        self.asked.append(f"{request.method} {request.url.path}")
        if request.url.path.endswith("/plan"):
            plan = {"revision": self.revision, "makespan_s": 30.0, "validated": True}
            return httpx.Response(200, json={**plan, "steps": [step(float(self.revision))]})
        self.revision = next(self.revisions)
        return httpx.Response(200, json={"mission": {"revision": self.revision}, "commands": []})


def test_each_new_revision_is_fetched_once() -> None:
    service = Service([1, 1, 2])
    listener = PlanListener(httpx.MockTransport(service))
    with httpx.Client(transport=listener, base_url="http://s") as client:
        for time_s in (0.0, 1.0, 2.5):
            answer = client.post("/v1/missions/m/reports", json={"time_s": time_s})
            assert answer.json()["commands"] == []
    assert [(plan.revision, plan.time_s) for plan in listener.plans] == [(1, 0.0), (2, 2.5)]
    assert listener.plans[1].steps[0].start_s == 2.0
    assert service.asked.count("GET /v1/missions/m/plan") == 2


def test_refused_reports_are_left_alone() -> None:
    listener = PlanListener(httpx.MockTransport(lambda _: httpx.Response(422, json={})))
    with httpx.Client(transport=listener) as client:
        assert client.post("http://s/v1/missions/m/reports", json={}).status_code == 422
    assert listener.plans == []
