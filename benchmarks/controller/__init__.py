"""Benchmark: controller."""
