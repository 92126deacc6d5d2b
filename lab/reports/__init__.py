# SPDX-License-Identifier: Apache-2.0
"""Reports: tables whose numbers are cells of other tables, folders that commands make, figures of stored tables."""
