# SPDX-License-Identifier: GPL-3.0-or-later
"""Eigenvalues and what is made of them, beside those of the manifolds."""

import subprocess
import sys

import numpy as np
import pytest

import remanifold as rm
from calculus_meshes import cube, known_by, torus_grid


def flat_klein_bottle(count, seed):
    """Isometric in R^5: (s, w) and (-s, w + pi) are one point."""
    s, w = np.random.default_rng(seed).random((2, count)) * [[2 * np.pi], [np.pi]]
    return np.stack(
        [
            np.sqrt(0.75) * np.cos(s),
            np.sin(s) * np.cos(w),
            np.sin(s) * np.sin(w),
            np.cos(s) * np.cos(2 * w) / 2,
            np.cos(s) * np.sin(2 * w) / 2,
        ],
        axis=1,
    )


# Random samples; relative errors as measured, with a margin of a half.
CLOSED = {
    "circle": (
        lambda: rm.datasets.circle(400, random_state=0),
        1,
        [0, 1, 1, 4, 4, 9, 9],
        0.003,
    ),
    "sphere": (
        lambda: rm.datasets.sphere(1000, random_state=0),
        2,
        [0, *[2] * 3, *[6] * 5],
        0.017,
    ),
    "flat torus": (
        lambda: rm.datasets.flat_torus(1000, random_state=0),
        2,
        [0, *[1] * 4, *[2] * 4],
        0.012,
    ),
    "Klein bottle": (
        lambda: flat_klein_bottle(1000, 0),
        2,
        [0, 1, *[2] * 2, *[4] * 3, *[5] * 4],
        0.02,
    ),
    "rotations": (
        lambda: rm.datasets.rotations(1500, random_state=0),
        3,
        [0, *[1] * 9],
        0.015,
    ),
}


@pytest.mark.parametrize("name", CLOSED)
def test_exact_spectra(name):
    draw, dim, exact, error = CLOSED[name]
    rec = rm.reconstruct(draw(), dim)
    found = rec.calculus.spectrum(len(exact))
    assert found.eigenvalues[0] == 0
    assert (np.diff(found.eigenvalues) >= 0).all()
    np.testing.assert_allclose(found.eigenvalues[1:], exact[1:], rtol=error)
    lumped = rec.calculus.mass(lumped=True)
    products = found.functions.T @ lumped @ found.functions
    np.testing.assert_allclose(products, np.eye(len(exact)), atol=1e-8)
    residual = (
        rec.calculus.stiffness() @ found.functions
        - lumped @ found.functions * found.eigenvalues
    )
    assert np.abs(residual).max() < 1e-8
    full = rec.calculus.spectrum(len(exact), lumped=False).eigenvalues
    assert (full[1:] > np.array(exact[1:])).all()


@pytest.mark.parametrize("per_side", [16, 24])  # dense, and by ARPACK
def test_natural_and_fixed_on_a_square(per_side):
    """Cosines and sines of the sides."""
    calculus = cube(per_side, 2).calculus
    natural = calculus.spectrum(4).eigenvalues / np.pi**2
    np.testing.assert_allclose(natural, [0, 1, 1, 2], rtol=0.01)
    ends = calculus.boundary_vertices
    fixed = calculus.spectrum(3, ends)
    np.testing.assert_allclose(fixed.eigenvalues / np.pi**2, [2, 5, 5], rtol=0.03)
    assert (fixed.functions[ends] == 0).all()


def test_components_by_themselves():
    grid, _ = torus_grid(8)
    apart = rm.SimplicialComplex(
        np.vstack([grid.vertices, 2 * grid.vertices, [[9] * 4]]),
        np.vstack([grid.simplices, grid.simplices + 64]),
    )
    found = apart.calculus.spectrum(10)
    one = grid.calculus.spectrum(12).eigenvalues
    expected = np.sort(np.concatenate([one, one / 4]))[:10]
    np.testing.assert_allclose(found.eigenvalues, expected, atol=1e-12)
    assert found.components[:6].tolist() == [0, 1, 1, 1, 1, 1]
    assert np.isnan(found.functions[-1]).all()
    assert (found.functions[64:128, 0] == 0).all()
    assert (found.functions[:64, 1:6] == 0).all()
    away = found.distances([0])
    assert np.isinf(away[0, 64:128]).all()
    assert np.isfinite(away[0, :64]).all()
    assert np.isnan(away[0, 128])
    assert np.isfinite(found.distances([0], "diffusion", 1.0)[0, :128]).all()
    with pytest.raises(ValueError, match=r"sources\[1\] is 128, expected a vertex"):
        found.distances([0, 128])
    few = apart.calculus.spectrum(1)
    assert few.eigenvalues.tolist() == [0]


def test_lengths_are_enough():
    grid, _ = torus_grid(8)
    for kind in ("gram", "distances"):
        found = known_by(kind, grid).calculus.spectrum(6).eigenvalues
        np.testing.assert_allclose(
            found, grid.calculus.spectrum(6).eigenvalues, atol=1e-10
        )


def test_embedding_unrolls_and_signature_is_even():
    """Where all places are alike all signatures are."""
    grid, angles = torus_grid(16)
    found = grid.calculus.spectrum(5)
    places = found.embedding(4)
    # In the space of the four functions the torus is again one: all at one distance.
    sizes = np.linalg.norm(places, axis=1)
    np.testing.assert_allclose(sizes, sizes[0])
    smooth = found.diffusion_map(0.5)
    np.testing.assert_allclose(smooth, places * np.exp(-0.5 * found.eigenvalues[1:]))
    signature = grid.calculus.spectrum(40).heat_kernel_signature([0.5, 2.0])
    # Product of two kernels of circles, at the place where heat started.
    circle = [
        np.exp(-t * np.arange(-40, 41) ** 2).sum() / (2 * np.pi) for t in (0.5, 2.0)
    ]
    np.testing.assert_allclose(signature.mean(axis=0), np.square(circle), rtol=0.05)
    assert angles.shape == (256, 2)


def test_distances_on_a_circle():
    """Closed forms: |x - y| (2 pi - |x - y|) is 2 pi times the squared commute distance."""
    angles = np.arange(400) * 2 * np.pi / 400
    points = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    ring = rm.SimplicialComplex(
        points, np.stack([np.arange(400), (np.arange(400) + 1) % 400], axis=1)
    )
    found = ring.calculus.spectrum(201)
    away = np.minimum(angles, 2 * np.pi - angles)
    np.testing.assert_allclose(
        found.distances(0, "commute")[0] ** 2,
        away * (2 * np.pi - away) / (2 * np.pi),
        atol=0.01,
    )
    # Sum over m of (2 - 2 cos(m t)) / (pi m^4).
    m = np.arange(1, 400)[:, None]
    expected = ((2 - 2 * np.cos(m * away)) / (np.pi * m**4)).sum(axis=0)
    np.testing.assert_allclose(found.distances(0)[0] ** 2, expected, atol=1e-3)
    spread = ((2 - 2 * np.cos(m * away)) * np.exp(-2 * m**2) / np.pi).sum(axis=0)
    np.testing.assert_allclose(
        found.distances(0, "diffusion", 1.0)[0] ** 2, spread, atol=1e-3
    )


@pytest.mark.slow
def test_the_same_again():
    script = (
        "import remanifold as rm\n"
        "rec = rm.reconstruct(rm.datasets.sphere(700, random_state=0), 2)\n"
        "print(rec.calculus.spectrum(9).functions.tobytes().hex())\n"
    )
    runs = {
        subprocess.run(
            [sys.executable, "-c", script], capture_output=True, check=True
        ).stdout
        for _ in range(2)
    }
    assert len(runs) == 1
    rec = rm.reconstruct(rm.datasets.sphere(700, random_state=0), 2)
    functions = rec.calculus.spectrum(9).functions
    size = np.abs(functions)
    first = (size >= size.max(axis=0) * (1 - 1e-6)).argmax(axis=0)
    assert (functions[first, np.arange(9)] > 0).all()


@pytest.mark.parametrize(
    ("call", "error", "says"),
    [
        (lambda c: c.spectrum(0), ValueError, "count is 0, expected at least 1"),
        (lambda c: c.spectrum(10), ValueError, "count is 10, but there are 9 vert"),
        (lambda c: c.spectrum(2, np.arange(8)), ValueError, "there are 1 vertices"),
        (lambda c: c.spectrum(3).embedding(3), ValueError, "only 2 functions"),
        (lambda c: c.spectrum(3).diffusion_map(0), ValueError, "time is 0"),
        (lambda c: c.spectrum(3).distances(0, "diffusion"), TypeError, "time goes"),
        (lambda c: c.spectrum(3).distances(0, time=1.0), TypeError, "time goes"),
        (lambda c: c.spectrum(3).distances(9), ValueError, r"sources\[0\] is 9"),
        (lambda c: c.spectrum(3).distances(0, "flow"), ValueError, "kind is 'flow'"),
        (
            lambda c: c.spectrum(3).heat_kernel_signature([1, -1]),
            ValueError,
            r"times\[1\] is -1",
        ),
    ],
)
def test_wrong_input(call, error, says):
    with pytest.raises(error, match=says):
        call(cube(2, 2).calculus)


def test_repr():
    found = cube(2, 1).calculus.spectrum(2)
    assert repr(found).startswith("Spectrum(vertices=3, functions=2, largest_eig")
