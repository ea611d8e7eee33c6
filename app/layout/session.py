"""A session of the page: its beginning and its end."""

from ..commands.loading import receiver
from ..commands.session import Session
from ..commands.watchers import follow
from ..jobs.jobs import Schedule
from ..widgets.view import SceneView


def begin(schedule: Schedule) -> Session:
    """Return a new session with its view and watchers.

    Parameters
    ----------
    schedule : callable
        Runs a function on the page's own thread; see `Jobs`.
    """
    view = SceneView(sizing_mode="stretch_both")
    session = Session(view, schedule)
    view.receiver = receiver(session)
    follow(session)
    return session
