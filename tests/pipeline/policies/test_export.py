import onnxruntime
import torch

from simgap.policies.export import ONNX_FILE, SCRIPT_FILE, export_policy
from simgap.policies.networks import Gaussian, Policy


def test_exported_policies_agree_with_the_policy(tmp_path):
    torch.manual_seed(0)
    gaussian = Gaussian(31, 4, [128, 128], 0.2, 0.5)
    with torch.no_grad():
        gaussian.mean[-1].weight.mul_(100.0)  # so that some actions reach their bounds
    export_policy(gaussian, tmp_path)
    observation = torch.randn(64, 31)
    with torch.no_grad():
        expected = Policy(gaussian)(observation)
    assert bool((expected.abs() == 1.0).any())
    assert bool((expected.abs() < 1.0).any())
    script = torch.jit.load(str(tmp_path / SCRIPT_FILE))
    torch.testing.assert_close(script(observation), expected, rtol=0.0, atol=1e-5)
    session = onnxruntime.InferenceSession(str(tmp_path / ONNX_FILE))
    for batch in (1, 64):
        (found,) = session.run(["action"], {"observation": observation[:batch].numpy()})
        torch.testing.assert_close(torch.from_numpy(found), expected[:batch], rtol=0.0, atol=1e-5)
