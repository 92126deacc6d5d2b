# SPDX-License-Identifier: Apache-2.0
"""Figures and tables of the thesis, one function each; lab/reproduce.py has the list of them."""
