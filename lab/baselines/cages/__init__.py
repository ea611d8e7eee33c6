"""Binding by coordinates of a cage."""
