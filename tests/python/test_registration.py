# SPDX-License-Identifier: BSD-3-Clause
"""Tests the registration of a mesh in the robot's frame, and its errors."""

import warnings

import numpy as np
import pytest

import keepout

model = np.array([[0, 95, 20], [70, 40, 35], [-72, 38, 30], [60, -60, 80], [-10, -20, 130.0]])
turn = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0]
turn *= np.linalg.det(turn)
measured = (model - [100, -50, 20]) @ turn  # R^T (p - t)
noisy = measured + np.random.default_rng(2).normal(0, 0.3, (5, 3))


def test_finds_the_true_matrix():
    fit = keepout.fit_rigid(measured, model)
    np.testing.assert_allclose(fit.mesh_from_robot[:3, :3], turn, atol=1e-12)
    np.testing.assert_allclose(fit.mesh_from_robot[:, 3], [100, -50, 20, 1], atol=1e-10)
    assert fit.fre < 1e-10 and fit.doubt == "" and abs(fit.scale - 1) < 1e-12
    assert "1000" in keepout.fit_rigid(measured / 1000, model).doubt
    assert "5 pairs" in repr(fit)


def test_weights_residuals_and_errors_are_those_of_numpy():
    weights = np.array([1, 4, 0.5, 2, 1])
    fit = keepout.fit_rigid(noisy, model.tolist(), weights=weights)
    matrix = fit.mesh_from_robot
    left = noisy @ matrix[:3, :3].T + matrix[:3, 3] - model
    np.testing.assert_allclose(fit.residuals, np.linalg.norm(left, axis=1), atol=1e-12)
    np.testing.assert_allclose(fit.fre, np.sqrt(weights @ (left**2).sum(axis=1) / weights.sum()))
    np.testing.assert_allclose(fit.estimated_fle, fit.fre * np.sqrt(5 / 3))
    # The reference is the linear least-squares problem of three rotations and three translations.
    cross = lambda p: np.array([[0, -p[2], p[1]], [p[2], 0, -p[0]], [-p[1], p[0], 0]])
    rows = [np.hstack([-cross(p), np.eye(3)]) for p in model]
    normal = sum(w * a.T @ a for w, a in zip(weights / weights.mean(), rows))
    at = np.hstack([-cross([20, -30, 20]), np.eye(3)])
    covariance = 0.5**2 / 3 * at @ np.linalg.inv(normal) @ at.T
    np.testing.assert_allclose(keepout.target_error(fit, (20, -30, 20), fle=0.5), covariance, rtol=1e-9)
    worst = np.sqrt(np.linalg.eigvalsh(covariance)[-1])
    margin = keepout.registration_margin(fit, (20, -30, 20), confidence=0.99, fle=0.5)
    np.testing.assert_allclose(margin, worst * np.sqrt(11.3449), rtol=1e-5)
    several = keepout.registration_margin(fit, [(20, -30, 20), (0, 0, 60)], fle=0.5)
    np.testing.assert_allclose(several, worst * np.sqrt(16.8119), rtol=1e-5)
    assert keepout.registration_margin(fit, (20, -30, 20)) > 0


def test_an_fle_that_contradicts_the_residuals_is_doubted():
    fit = keepout.fit_rigid(noisy, model)
    assert fit.doubt_of(0.5) == ""
    assert "the FRE is" in fit.doubt_of(0.05)
    for use in (keepout.registration_margin, keepout.target_error):
        with pytest.warns(UserWarning, match="do not trust the registration: the FRE is .* FLE of 0.05"):
            use(fit, (0, 0, 0), fle=0.05)
        with pytest.warns(UserWarning, match="do not trust the registration: .*1000"):
            use(keepout.fit_rigid(measured / 1000, model), (0, 0, 0))
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            use(fit, (0, 0, 0), fle=0.5)
            use(fit, (0, 0, 0))
        for fle in (0.0, -1.0, np.nan):
            with pytest.raises(keepout.Error, match="fle must be above 0 and finite"):
                use(fit, (0, 0, 0), fle=fle)
            with pytest.raises(keepout.Error, match="fle must be above 0 and finite"):
                fit.doubt_of(fle)
