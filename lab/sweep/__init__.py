# SPDX-License-Identifier: Apache-2.0
"""Parts of `tactus sweep`: plan.py reads and checks, points.py computes, table.py writes tables and figures."""
