import pytest
import torch
from torch.autograd.functional import jacobian

from simgap.models import hidden_layer
from simgap.models.levenberg_marquardt import Problem, minimise


class Rosenbrock(Problem):
    """Residuals 10·(y − x²) and 1 − x, the usual banana valley."""

    def residuals(self, parameters):
        x, y = parameters
        return torch.stack([10.0 * (y - x**2), 1.0 - x])

    def error(self, parameters):
        return float(self.residuals(parameters).square().mean())

    validation_error = error

    def normal_equations(self, parameters):
        slopes = parameters.new_tensor([[-20.0 * parameters[0], 10.0], [-1.0, 0.0]])
        return slopes.T @ slopes / 2, slopes.T @ self.residuals(parameters) / 2


class Overfitted(Rosenbrock):
    """Its validation prefers the start."""

    def validation_error(self, parameters):
        return float((parameters - torch.tensor([-1.2, 1.0], dtype=torch.float64)).square().sum())


START = torch.tensor([-1.2, 1.0], dtype=torch.float64)


def test_the_valley_is_followed_to_its_end():
    solution = minimise(Rosenbrock(), START, most=100, patience=100)
    assert torch.allclose(solution.parameters, torch.ones(2, dtype=torch.float64), atol=1e-6)
    fitted = [error for error, _ in solution.errors]
    assert fitted == sorted(fitted, reverse=True)


def test_the_validation_stops_it_and_chooses():
    solution = minimise(Overfitted(), START, most=100, patience=3)
    assert len(solution.errors) == 3
    assert torch.equal(solution.parameters, START)


@pytest.mark.parametrize(("inputs", "hidden"), [(1, 1), (3, 4)])
def test_the_jacobian_of_the_network_is_that_of_automatic_differentiation(inputs, hidden):
    random = torch.Generator().manual_seed(0)
    parameters = hidden_layer.start(inputs, hidden, random)
    assert len(parameters) == hidden_layer.parameter_count(inputs, hidden)
    samples = torch.randn(7, inputs, generator=random, dtype=torch.float64)
    expected = jacobian(lambda values: hidden_layer.predict(values, samples), parameters)
    assert torch.allclose(hidden_layer.jacobian(parameters, samples), expected, atol=1e-12)


def test_the_normal_equations_are_the_means_over_all_samples():
    random = torch.Generator().manual_seed(1)
    parameters = hidden_layer.start(2, 3, random)
    samples = torch.randn(5000, 2, generator=random, dtype=torch.float64)  # more than are worked on at a time
    targets = torch.randn(5000, generator=random, dtype=torch.float64)
    problem = hidden_layer.Regression(samples, targets, samples[:10], targets[:10])
    gram, gradient = problem.normal_equations(parameters)
    slopes = hidden_layer.jacobian(parameters, samples)
    residual = hidden_layer.predict(parameters, samples) - targets
    assert torch.allclose(gram, slopes.T @ slopes / 5000)
    assert torch.allclose(gradient, slopes.T @ residual / 5000)
    assert problem.error(parameters) == pytest.approx(float(residual.square().mean()))
