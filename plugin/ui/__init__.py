"""Styles, words, translations, warnings, missing packages."""
