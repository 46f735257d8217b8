"""Flat vegetation from laser remission: learned from vibration, mapped, avoided (Wurm, chapter 6).

Training needs scikit-learn (`marsupial[vegetation]`). Vegetation is the positive class.
"""
