"""Progress that threads share: one whole, told by one thread at a time."""

import threading
import time

import pytest

from cutcell import Cancelled
from cutcell.runtime.progress import Shares, share_of


def test_shares_are_told_as_a_whole():
    reports = []
    shares = Shares(lambda stage, done: reports.append((stage, done)), "distances", 2)
    for share, done in ((0, 0.5), (1, 0.25), (0, 1.0), (1, 1.0)):
        shares.tell(share, done)
    assert reports == [("distances", x) for x in (0.25, 0.375, 0.625, 1.0)]


def test_nobody_is_called_by_two_threads_at_once():
    inside, most = [], []

    def slow(stage, done):
        inside.append(done)
        most.append(len(inside))
        time.sleep(0.001)
        inside.pop()

    shares = Shares(slow, "distances", 4)
    work = [
        threading.Thread(target=lambda s=s: [shares.tell(s, k / 20) for k in range(20)])
        for s in range(4)
    ]
    for thread in work:
        thread.start()
    for thread in work:
        thread.join()
    assert len(most) == 80
    assert max(most) == 1


def test_who_cancels_stops_every_share():
    def stop(stage, done):
        raise Cancelled

    shares = Shares(stop, "distances", 2)
    for share in (0, 1, 0):
        with pytest.raises(Cancelled):
            shares.tell(share, 0.5)


def test_parts_of_the_work_are_told_as_fractions_of_the_whole():
    reports = []
    tell = share_of(share_of(reports.append, 0.5, 1), 0, 0.5)
    for done in (0, 0.5, 1):
        tell(done)
    assert reports == [0.5, 0.625, 0.75]
