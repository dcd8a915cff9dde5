"""Formats that the C library leaves out. SPDX-License-Identifier: MIT"""
