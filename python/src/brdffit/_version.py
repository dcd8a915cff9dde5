"""Version of the package, the same as the C library's. SPDX-License-Identifier: MIT"""
__version__ = "0.2.0"
