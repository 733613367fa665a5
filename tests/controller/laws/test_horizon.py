"""The next revolutions as a quadratic program."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from controller.laws.horizon import (
    EXCESS,
    LENGTH,
    MOVES,
    Outlook,
    horizon,
    lingering,
    remaining,
    vectors,
)
from controller.signals.ports import Floats

LAGS = (0.5, 3.0, 9.0)


def driven(axes: float, commands: Floats, *, lag: float) -> tuple[Floats, float]:
    """Mean of each revolution, and the end, of ``T·dx/dt = u − x``, integrated numerically."""
    means = []
    for command in commands:
        course = solve_ivp(
            lambda _, at, u=command: [(u - at[0]) / lag, at[0]],
            (0.0, 1.0),
            [axes, 0.0],
            rtol=1e-10,
            atol=1e-12,
        )
        axes = float(course.y[0, -1])
        means.append(float(course.y[1, -1]))
    return np.array(means), axes


@pytest.mark.parametrize("lag", LAGS)
def test_means_are_those_of_the_differential_equation(lag: float) -> None:
    commands = np.random.default_rng(5).uniform(0.1, 2.0, LENGTH)
    over = horizon(lag)
    wanted, _ = driven(0.7, commands, lag=lag)
    np.testing.assert_allclose(over.decay * 0.7 + over.response @ commands, wanted, rtol=1e-7)


@pytest.mark.parametrize("lag", LAGS)
def test_way_left_after_a_revolution_is_that_of_the_differential_equation(lag: float) -> None:
    means, end = driven(1.0, np.zeros(1), lag=lag)
    assert lingering(lag) == pytest.approx(means[0], rel=1e-8)
    assert remaining(lag) == pytest.approx(end, rel=1e-8)


OVERRIDES = st.floats(0.05, 2.0)
ROWS = st.lists(OVERRIDES, min_size=LENGTH, max_size=LENGTH).map(np.array)


@given(
    lag=st.sampled_from(LAGS), axes=OVERRIDES, command=OVERRIDES, caps=ROWS, commands=ROWS,
    slack=ROWS,
)  # fmt: skip
def test_cost_and_constraints_are_those_written_out(
    lag: float, axes: float, command: float, caps: Floats, commands: Floats, slack: Floats
) -> None:
    over = horizon(lag)
    targets = np.minimum.accumulate(caps)
    outlook = Outlook(
        axes=axes, command=command, caps=caps, targets=targets,
        floor=0.1, ceiling=1.5, rise=0.5, fall=1.0,
    )  # fmt: skip
    found, point = vectors(over, outlook), np.concatenate([commands, slack])
    means, state = [], axes
    for each in commands:
        means.append(lingering(lag) * state + (1.0 - lingering(lag)) * each)
        state = remaining(lag) * state + (1.0 - remaining(lag)) * each
    moves = np.diff(commands, prepend=command)

    def cost(error: Floats, move: Floats, excess: Floats) -> float:
        return float(error @ error + MOVES * move @ move + EXCESS * excess @ excess)

    upper = over.quadratic.toarray()
    full = upper + np.triu(upper, 1).T
    # The program leaves out what no decision changes: the cost of no command at all.
    nothing = cost(over.decay * axes - targets, np.eye(LENGTH)[0] * -command, np.zeros(LENGTH))
    wanted = cost(np.array(means) - targets, moves, slack) - nothing
    assert 0.5 * point @ full @ point + found.linear @ point == pytest.approx(wanted, abs=1e-8)

    rows = over.rows @ point
    room = np.array(means) - slack - caps
    np.testing.assert_allclose((rows - found.upper)[:LENGTH], room, atol=1e-9)
    assert np.isneginf(found.lower[:LENGTH]).all()
    np.testing.assert_allclose(
        (rows - found.lower)[LENGTH:], np.concatenate([commands - 0.1, moves + 1.0]), atol=1e-9
    )
    np.testing.assert_allclose(
        (found.upper - rows)[LENGTH:], np.concatenate([1.5 - commands, 0.5 - moves]), atol=1e-9
    )
