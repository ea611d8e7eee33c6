"""Commands of the page: functions that take a session and change its state."""
