"""Random shops for tests: lines of groups of machines, with all that a shop file may say."""

from random import Random

TIMES = (
    'kind = "exponential", mean = {mean}',
    'kind = "uniform", low = {low}, high = {high}',
    'kind = "gamma", mean = {mean}, variation = 0.5',
    'kind = "lognormal", mean = {mean}, variation = 0.4',
)

DAY = """
[[shift]]
name = "day"
hours = ["Mon-Fri 06:00-14:00", "Sat 22:00-02:00"]
"""

CREW = """
[[crew]]
name = "setters"
members = 2
tasks = ["batch set-up", "repair"]
"""


def random_shop(seed: int, *, is_plain: bool) -> str:
    """TOML text of a shop, always the same for a seed.

    Parameters
    ----------
    seed : int
    is_plain : bool
        Whether batches may pass its machines in one event: nothing but failures by machining
        time happens within them, and times are random.
    """
    draw = Random(seed)
    groups = draw.randint(1, 3)
    hours = draw.choice([20, 60])
    text = [f'hours = {hours}\nwarm_up_hours = {draw.choice([0, 2.3])}\nstart = "Mon 05:00"']
    if not is_plain:
        text.append(DAY)
    text += [_machine(draw, row, is_plain=is_plain) for row in range(groups)]
    for row in range(groups - 1):
        capacity = draw.choice(["", "capacity = 0", "capacity = 1", "capacity = 3"])
        text.append(f'[[buffer]]\nname = "b{row}"\n{capacity}')
    if not is_plain and draw.random() < 0.5:
        text.append(CREW)
    text += [_product(draw, name, groups) for name in ["red", "blue"][: draw.randint(1, 2)]]
    return "\n".join(text)


def _machine(draw: Random, row: int, *, is_plain: bool) -> str:
    """A group of machines."""
    text = [
        f'[[machine]]\nname = "m{row}"\ncount = {draw.randint(1, 3)}\nidle_power_w = 300',
        "[machine.handling]",
        f"part_setup_s = {_time(draw, 20.0)}\npart_setup_w = 500",
    ]
    if draw.random() < 0.7:
        text.append(f"part_ejection_s = {_time(draw, 10.0)}\npart_ejection_w = 250")
    if draw.random() < 0.7:
        text.append(f"batch_setup_s = {_time(draw, 60.0)}\nbatch_ejection_s = 30")
    if draw.random() < 0.6:
        counts = "machining" if is_plain else draw.choice(["machining", "clock"])
        text.append(
            f'[[machine.failure]]\ncounts = "{counts}"\nscrap = 0.5\n'
            'every_h = { kind = "exponential", mean = 2 }\n'
            'repair_min = { kind = "exponential", mean = 15 }'
        )
    if not is_plain and draw.random() < 0.5:
        text.append(
            f'[[machine.maintenance]]\ncounts = "{draw.choice(["machining", "clock"])}"\n'
            "every_h = 3\ntakes_min = 6"
        )
    if not is_plain and draw.random() < 0.3:
        text.insert(1, 'shift = "day"')
    return "\n".join(text)


def _product(draw: Random, name: str, groups: int) -> str:
    """A product that visits the groups in order."""
    arrival = f"arrival_min = {_time(draw, 20.0)}" if draw.random() < 0.3 else ""
    batches = f"batches = {draw.randint(5, 60)}" if draw.random() < 0.3 else ""
    batch = draw.choice([1, 2, 10, 40])
    text = [
        f'[[product]]\nname = "{name}"\nbatch = {batch}\n{arrival}\n{batches}',
        f"priority = {draw.randint(0, 1)}",
    ]
    for row in range(groups):
        into = f'into = "b{row}"' if row < groups - 1 else ""
        scrap = draw.choice([0.0, 0.0, 0.1])
        text.append(
            f'[[product.step]]\nmachines = ["m{row}"]\ntime_s = {_time(draw, 150.0)}\n'
            f"power_w = 2000\nscrap = {scrap}\n{into}"
        )
    return "\n".join(text)


def _time(draw: Random, mean: float) -> str:
    """A distribution around a mean."""
    found = draw.choice(TIMES).format(mean=mean, low=0.8 * mean, high=1.2 * mean)
    return f"{{ {found} }}"
