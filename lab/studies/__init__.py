# SPDX-License-Identifier: Apache-2.0
"""Studies of `tactus bench`: points of tactus-study put together, as tables, CSV, JSON and figures."""
