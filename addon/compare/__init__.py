# SPDX-FileCopyrightText: 2026 Shadow Layers contributors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Measures, tables and the report page. NumPy only: no bpy, no native module."""
