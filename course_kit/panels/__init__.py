"""Panels: things in a notebook that show and poke live nodes, made of ipywidgets and anywidget.

Every panel is a `Panel`: displayed as a widget where there is one, described in words everywhere else. A panel shown
again for the same thing replaces the one before; panels end with the lab.
"""

from __future__ import annotations
