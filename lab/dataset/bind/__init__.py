"""Bind all rigs of a data set, on one machine or several."""
