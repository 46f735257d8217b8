"""Where a rover waits to be fetched: meeting points that a carrier can get to.

A room may hold ground that suits carriers and that none of them can reach; its border is a meeting
point like any other, and a rover that waits there waits for ever.
"""

from math import isfinite

from domains.mission_state import Activity
from service.coordination.strategy import Situation
from service.coordination.travel import Travel


def pick_up_points(situation: Situation, travel: Travel) -> list[str]:
    """Ids of the meeting points that some carrier can get to; of all, if there are none."""
    state = situation.state
    meetings = [meeting.id for meeting in state.meeting_points]
    carriers = [
        robot.id
        for robot in state.robots
        if situation.models[robot.type].capacity > 0 and robot.activity is not Activity.FAILED
    ]
    rows = travel.times_s(carriers, meetings)
    served = [
        meeting
        for column, meeting in enumerate(meetings)
        if any(isfinite(row[column]) for row in rows)
    ]
    return served or meetings
