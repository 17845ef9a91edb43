"""Boolean signals as lists of edges: (instant, level behind it), low at first; their parts."""

from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[Any]
Edges = list[tuple[float, bool]]

MODULUS = 2**31 - 1


def level_at(edges: Edges, time_s: Vector) -> Vector:
    """The level at each instant."""
    instants = np.array([t for t, _ in edges])
    levels = np.array([0.0, *(float(level) for _, level in edges)])
    return levels[np.searchsorted(instants, time_s, side="right")]


def last_edge(edges: Edges, level: bool, time_s: Vector) -> Vector:
    """The instant of the last edge to `level`, 0 before the first."""
    instants = np.array([0.0, *(t for t, to in edges if to is level)])
    return instants[np.searchsorted(instants[1:], time_s, side="right")]


def count_of(edges: Edges, level: bool, time_s: Vector) -> Vector:
    """How many edges to `level` there have been."""
    instants = np.array([t for t, to in edges if to is level])
    return np.searchsorted(instants, time_s, side="right").astype(float)


def within(spans: Sequence[tuple[float, float]], time_s: Vector) -> Vector:
    """1 within one of the spans."""
    found = np.zeros_like(time_s)
    for begin, end in spans:
        found[(time_s >= begin) & (time_s < end)] = 1.0
    return found


def sine_edges(omega: float, phase: float, until: float) -> Edges:
    """Edges of sin(omega t - phase) > 0, which is low at 0."""
    count = int((omega * until - phase) / np.pi)
    return [((k * np.pi + phase) / omega, k % 2 == 0) for k in range(count + 1)]


def lehmer(multiplier: int, state: int) -> int:
    """The next state of the multiplicative congruential generator modulo 2^31 - 1."""
    return multiplier * state % MODULUS


def uniform(multiplier: int, seed: int, count: int) -> list[float]:
    """The first numbers of an edge sequence, within 0..1."""
    state = lehmer(multiplier, 1 + 742938285 * seed % (MODULUS - 1))
    found = []
    for _ in range(count):
        found.append(float(Fraction(state, MODULUS)))
        state = lehmer(multiplier, state)
    return found


def delayed(edges: Edges, delay: float, jitter: float, seed: int) -> tuple[Edges, list[Any]]:
    """The edges behind a delay with jitter, and the spans during which each is under way."""
    found: Edges = []
    spans = []
    for level, multiplier in ((True, 16807), (False, 48271)):
        mine = [t for t, to in edges if to is level]
        for t, u in zip(mine, uniform(multiplier, seed, len(mine)), strict=True):
            arrival = t + max(0.0, delay + jitter * (2 * u - 1))
            found.append((arrival, level))
            spans.append((t, arrival))
    return sorted(found), spans


def bounced(edges: Edges, closing: int, opening: int, duration: float) -> tuple[Edges, list[Any]]:
    """The edges with their bouncing, and the spans during which the contact bounces."""
    found: Edges = []
    spans = []
    ends = [t for t, _ in edges[1:]] + [np.inf]
    for (t, level), end in zip(edges, ends, strict=True):
        times = 2 * (closing if level else opening)
        mine = [(t + k * duration / max(1, times), level ^ (k % 2 == 1)) for k in range(times + 1)]
        kept = [edge for edge in mine if edge[0] < end]
        if found and found[-1][1] is level:
            kept = kept[1:]  # it bounced to this level already
        found += kept
        spans.append((t, min(end, t + duration if times else t)))
    return found, spans


def edge_delay(time_s: Vector) -> Mapping[str, Vector]:
    """A square wave of 40 Hz behind 30 ms with up to 3 ms to either side."""
    edges, spans = delayed(sine_edges(251.3, 0.3, float(time_s[-1])), 30e-3, 3e-3, 77)
    return {
        "rising_time": last_edge(edges, True, time_s),
        "falling_time": last_edge(edges, False, time_s),
        "rising_count": count_of(edges, True, time_s),
        "waiting": within(spans, time_s),
    }


def contact_bounce(time_s: Vector) -> Mapping[str, Vector]:
    """Two closings; the second one ends while the contact still bounces."""
    touches: Edges = [(0.01003, True), (0.02003, False), (0.03003, True), (0.03074, False)]
    edges, spans = bounced(touches, 3, 2, 1.3e-3)
    return {
        "rising_time": last_edge(edges, True, time_s),
        "falling_time": last_edge(edges, False, time_s),
        "rising_count": count_of(edges, True, time_s),
        "bouncing": within(spans, time_s),
    }


def switch_on_delay(time_s: Vector) -> Mapping[str, Vector]:
    """On until 30.1 ms, and from 40.2 ms on; ready 12.3 ms later."""
    ready: Edges = [(0.0123, True), (0.0301, False), (0.0402 + 0.0123, True)]
    return {
        "ready": level_at(ready, time_s),
        "waiting": within([(0.0, 0.0123), (0.0402, 0.0525)], time_s),
        "ready_time": last_edge(ready, True, time_s),
    }


def level_filter(time_s: Vector) -> Mapping[str, Vector]:
    """What lasts for 2 ms passes 2 ms later."""
    rest = 2e-3
    passed: Edges = [
        (0.02003 + rest, True),
        (0.02205 + rest, False),
        (0.03003 + rest, True),
    ]
    resting = [
        (0.01003, 0.01202),
        (0.02003, 0.02003 + rest),
        (0.02205, 0.02205 + rest),
        (0.03003, 0.03003 + rest),
        (0.03503, 0.03603),
    ]
    return {
        "level": level_at(passed, time_s),
        "rising_time": last_edge(passed, True, time_s),
        "falling_time": last_edge(passed, False, time_s),
        "waiting": within(resting, time_s),
    }
