"""How far colours differ for an eye: CIEDE2000 (Sharma, Wu and Dalal 2005), for full and for colour-blind sight."""

import numpy as np
from colorspacious import cspace_convert

SIGHTS = {"normal": None, "protan": "protanomaly", "deutan": "deuteranomaly"}
"""Sights by the names that colorspacious has for them; of the strongest kind (Machado and others 2009)."""


def seen(colors, sight):
    """What an eye makes of colours (n, 3) from 0 to 255, in CIELAB."""
    values = np.asarray(colors, dtype=float) / 255.0
    if SIGHTS[sight] is not None:
        space = {"name": "sRGB1+CVD", "cvd_type": SIGHTS[sight], "severity": 100}
        values = np.clip(cspace_convert(values, space, "sRGB1"), 0.0, 1.0)
    return cspace_convert(values, "sRGB1", "CIELab")


def difference(one, other):
    """CIEDE2000 between two colours of CIELAB."""
    (light_1, a_1, b_1), (light_2, a_2, b_2) = one, other
    mean_chroma = (np.hypot(a_1, b_1) + np.hypot(a_2, b_2)) / 2.0
    stretch = 1.5 - 0.5 * np.sqrt(mean_chroma**7 / (mean_chroma**7 + 25.0**7))
    chroma_1, chroma_2 = np.hypot(stretch * a_1, b_1), np.hypot(stretch * a_2, b_2)
    hue_1, hue_2 = (np.degrees(np.arctan2(b, stretch * a)) % 360.0 for a, b in ((a_1, b_1), (a_2, b_2)))
    turn = 0.0 if chroma_1 * chroma_2 == 0.0 else (hue_2 - hue_1 + 180.0) % 360.0 - 180.0
    hue_step = 2.0 * np.sqrt(chroma_1 * chroma_2) * np.sin(np.radians(turn / 2.0))
    light, chroma = (light_1 + light_2) / 2.0, (chroma_1 + chroma_2) / 2.0
    hue = hue_1 + hue_2 if chroma_1 * chroma_2 == 0.0 else (hue_1 + turn / 2.0) % 360.0

    def cos(times, away):
        return np.cos(np.radians(times * hue + away))

    hues = 1.0 - 0.17 * cos(1, -30) + 0.24 * cos(2, 0) + 0.32 * cos(3, 6) - 0.20 * cos(4, -63)
    by_light = (light_2 - light_1) / (1.0 + 0.015 * (light - 50.0) ** 2 / np.sqrt(20.0 + (light - 50.0) ** 2))
    by_chroma = (chroma_2 - chroma_1) / (1.0 + 0.045 * chroma)
    by_hue = hue_step / (1.0 + 0.015 * chroma * hues)
    rotation = -2.0 * np.sqrt(chroma**7 / (chroma**7 + 25.0**7))
    rotation *= np.sin(np.radians(60.0 * np.exp(-(((hue - 275.0) / 25.0) ** 2))))
    return float(np.sqrt(by_light**2 + by_chroma**2 + by_hue**2 + rotation * by_chroma * by_hue))
