"""Shares of joints corrected by a small model that learned from rigs of many makers."""
