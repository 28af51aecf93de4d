"""Processes that grade one submission after another, and the messages between them."""
