"""What Sphinx does not bring: our docstrings, mathematics without scripts, headers and help texts.

SPDX-License-Identifier: MIT
"""
