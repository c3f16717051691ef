"""Makes the pairs of pictures in this folder and `expected.toml`, their FLIP by NVIDIA's own code.

    pip install flip-evaluator==1.7 numpy pillow
    python3 make.py

The pictures are 8-bit sRGB. For each pair `expected.toml` holds the mean of NVIDIA's LDR-FLIP map
(its own mean, of single precision) at the default 67.02 pixels per degree, and entries of the map:
two corners, the middle, the largest, and some at random. NVIDIA computes in single precision, and
that is what limits the agreement: see `../flip.rs`.
"""

from pathlib import Path

import flip_evaluator
import numpy as np
from PIL import Image

HERE = Path(__file__).parent
rng = np.random.default_rng(1999)


def grid(width, height):
    """Columns and rows of the pixels, from 0 to 1."""
    return np.meshgrid(np.linspace(0, 1, width), np.linspace(0, 1, height))


def scene(width, height):
    """Smooth colours with a disc."""
    x, y = grid(width, height)
    rgb = np.stack([0.2 + 0.6 * x, 0.3 + 0.4 * y, 0.7 - 0.5 * x * y], axis=-1)
    rgb[(x - 0.5) ** 2 + (y - 0.5) ** 2 < 0.06] = [0.9, 0.4, 0.1]
    return rgb


def pairs():
    """Name, reference and estimate, sRGB in [0, 1]."""
    base = scene(40, 30)
    yield "identical", base, base

    # A constant shift of all channels.
    yield "shift", base, base + 0.06

    # Colour without much luminance: red and green, blue and yellow change places in stripes.
    x, y = grid(48, 32)
    stripes = np.sin(2 * np.pi * 6 * x) > 0
    warm, cold = [0.75, 0.35, 0.30], [0.30, 0.55, 0.35]
    blue, yellow = [0.35, 0.35, 0.90], [0.45, 0.42, 0.10]
    upper = np.where(stripes[..., None], warm, cold)
    lower = np.where(stripes[..., None], blue, yellow)
    yield "colour", np.where((y < 0.5)[..., None], upper, lower), np.where(
        (y < 0.5)[..., None], upper[:, ::-1], lower[:, ::-1]
    )

    # An oblique edge, jagged and smooth.
    x, y = np.meshgrid(np.arange(64), np.arange(48))
    distance = 0.3 * (x - 32) + (y - 24)
    jagged = np.where(distance > 0, 0.9, 0.1)
    smooth = 0.1 + 0.8 * np.clip(distance + 0.5, 0, 1)
    yield "edge", np.repeat(smooth[..., None], 3, axis=-1), np.repeat(jagged[..., None], 3, axis=-1)

    # Single bright pixels, one of them in a corner, and a dark line that vanishes.
    reference = np.full((32, 36, 3), 0.25)
    reference[20, 4:30] = 0.05
    estimate = np.full((32, 36, 3), 0.25)
    for row, column in [(0, 0), (8, 9), (9, 24), (31, 20)]:
        estimate[row, column] = 1.0
    yield "points", reference, estimate

    # Noise, of the kind of few samples per pixel.
    yield "noise", base, base + rng.normal(0, 0.12, base.shape)

    # The largest differences there are, and pictures narrower than the filters.
    x, y = np.meshgrid(np.arange(5), np.arange(33))
    checker = ((x + y) % 2)[..., None].astype(float)
    yield "narrow", checker * [0.0, 1.0, 0.0], np.repeat(checker[::-1], 3, axis=-1) * [0.0, 0.0, 1.0]

    # No structure at all: random colours.
    yield "random", rng.random((24, 32, 3)), rng.random((24, 32, 3))


def main():
    lines = ["# Made by make.py with flip-evaluator 1.7."]
    for name, *pictures in pairs():
        paths = [HERE / f"{name}-reference.png", HERE / f"{name}-estimate.png"]
        for path, picture in zip(paths, pictures):
            levels = np.rint(255 * np.clip(picture, 0, 1)).astype(np.uint8)
            Image.fromarray(levels).save(path, optimize=True)
        flip, mean, parameters = flip_evaluator.evaluate(
            str(paths[0]), str(paths[1]), "LDR", applyMagma=False
        )
        assert abs(parameters["ppd"] - 67.02064) < 1e-4
        flip = flip[..., 0]
        height, width = flip.shape
        largest = np.unravel_index(flip.argmax(), flip.shape)
        spots = [(0, 0), (height - 1, width - 1), (height // 2, width // 2), largest]
        spots += [(rng.integers(height), rng.integers(width)) for _ in range(8)]
        lines += ["", f"[{name}]", f"mean = {mean:.8f}", "pixels = ["]
        lines += [f"    [{x}, {y}, {flip[y, x]:.8f}]," for y, x in spots]
        lines += ["]"]
    (HERE / "expected.toml").write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
