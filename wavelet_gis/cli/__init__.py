"""The command line ``terrain-wavelets``: arguments, messages, progress on a terminal."""

from .main import main

__all__ = ["main"]
