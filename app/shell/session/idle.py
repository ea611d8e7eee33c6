"""Message to the browser when no work is left: tests wait for it before they look."""

from ...document.session import Session
from ...server.protocol.received import AskIdle


def watch(session: Session) -> None:
    """Answer each question of the browser once, when no work is left.

    Panel handles all earlier messages, and the changes of widgets that it holds back, first.
    """

    def answer(number: int) -> None:
        if session.work.busy:  # scheduled actions have begun more work
            session.work.when_idle(lambda: answer(number))
        else:
            session.view.answer(idle=number)

    def wait(message: AskIdle) -> None:
        session.work.when_idle(lambda: answer(message.number))

    session.view.listen(AskIdle, wait)
