import torch

from benchmarks.laps import Laps
from benchmarks.training import BARE, OURS, Problem, bare, new_network, ours, written


def test_the_project_and_the_bare_loop_do_the_same_work_bit_by_bit():
    problem = Problem.drawn(windows=256, batch=128)
    trained, plain, untrained = new_network(), new_network(), new_network()
    ours(trained, problem)
    bare(plain, problem)
    plain_weights, first = plain.state_dict(), untrained.state_dict()
    for name, tensor in trained.state_dict().items():
        assert torch.equal(tensor, plain_weights[name])
    assert any(not torch.equal(tensor, first[name]) for name, tensor in plain_weights.items())


def test_the_page_states_ratio_and_time_of_an_epoch():
    laps = {512: {OURS: Laps((3000.0, 4000.0, 2000.0)), BARE: Laps((4000.0, 5000.0, 4000.0))}}
    page = written(laps, windows=120_000, rounds=3, load_before=0.0)
    assert "| 512 | 3,000 (2,000–4,000) | 4,000 (4,000–5,000) | 75% |" in page
    assert "One epoch over 120,000 windows takes 40 s with batches of 512" in page
