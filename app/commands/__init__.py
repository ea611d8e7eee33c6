"""What happens on the page: functions that are given a session, and change its state."""
