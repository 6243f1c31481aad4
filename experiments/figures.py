# SPDX-License-Identifier: BSD-3-Clause
"""How the figures look. A figure is drawn once, for paper and for pages in light and in dark."""
from __future__ import annotations

import matplotlib

matplotlib.use("Agg")
