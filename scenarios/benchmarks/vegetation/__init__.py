"""Vegetation classifiers: classifications per second of SVM and LDA on one core."""

from scenarios.benchmarks.vegetation.classification_speed import run

__all__ = ["run"]
