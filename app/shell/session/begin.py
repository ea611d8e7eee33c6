"""A session of the page: its beginning and its end."""

from ...derive.jobs import Schedule
from ...document.loading import receiver
from ...document.session import Session
from ...features.state import PageState
from ...widgets.view import SceneView
from .watchers import follow


def begin(schedule: Schedule) -> Session:
    """Return a new session with its view and watchers; see `derive.jobs.Schedule`."""
    view = SceneView(sizing_mode="stretch_both")
    session = Session(view, schedule, PageState())
    view.receiver = receiver(session)
    follow(session)
    return session
