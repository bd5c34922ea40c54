import torch

from simgap.policies.networks import Gaussian


def test_only_deviations_that_are_smaller_are_raised():
    gaussian = Gaussian(2, 3, [8], 0.2, deviation=0.3)
    with torch.no_grad():
        gaussian.log_deviation[0] = -4.0
    mean = gaussian(torch.ones(1, 2))[0]
    gaussian.widen(0.2)
    again, deviation = gaussian(torch.ones(1, 2))
    torch.testing.assert_close(deviation[0], torch.tensor([0.2, 0.3, 0.3]))
    assert torch.equal(again, mean)
