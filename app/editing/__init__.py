"""Foundation of edits: their commands, their results and their controls on the page."""
