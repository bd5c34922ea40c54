"""White-box model: first principles with parameters from least squares.

Increments and terms are averaged with the same test functions first, which keeps the noise of the recording from
making the parameters small (Messenger & Bortz 2021, "Weak SINDy", SIAM Multiscale Modeling & Simulation 19(3)).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar

import torch
from torch import Tensor, nn

from simgap.errors import InputError
from simgap.models.contract import DynamicsModel, FitContext
from simgap.models.examples import Examples, one_step_loss
from simgap.models.motion_equations import KNOWN, TERMS, Terms
from simgap.models.restoring import take_tensors
from simgap.models.settings import ModelSettings, Training
from simgap.models.windows import Series
from simgap.physics.weak_form import moving_mean_of, moving_window


@dataclass
class WhiteBoxSettings(ModelSettings):
    """Settings of the white box, which sees the newest sample of the window alone."""

    name: str = "white_box"
    averaging: float = 0.3  # s, of the windows over which the equations of motion are averaged


class WhiteBoxModel(DynamicsModel):
    """Known acceleration plus terms times coefficients, in the precision of what it is given."""

    settings_class: ClassVar[type[ModelSettings]] = WhiteBoxSettings
    kinds: ClassVar[frozenset[str] | None] = frozenset(TERMS)
    fits_residuals = False
    settings: WhiteBoxSettings
    changes: nn.ParameterList | None = None
    """Of the fitted coefficients by target, each in percent: what a hybrid learns of them; None: nothing."""

    def fit(
        self, train: Series, validation: Series, training: Training, context: FitContext | None = None
    ) -> float:
        """Solve each equation of motion; the validation series only scores."""
        examples, held = self.examples(train, "training"), self.examples(validation, "validation")
        pieces = [self._averages(examples, *bounds) for bounds in train.bounds.tolist()]
        self.coefficients = [_solved(*zip(*parts, strict=True)) for parts in zip(*pieces, strict=True)]
        return one_step_loss(self.increments, examples, held)

    def increments(self, features: Tensor) -> Tensor:
        """Return the acceleration at the newest sample times the step."""
        newest = features[:, -1]
        accelerations = [
            torch.stack(terms, dim=-1) @ own.to(newest)
            for terms, own in zip(self._terms(newest), self._changed(), strict=True)
        ]
        return self.time_step * (self._known(newest) + torch.stack(accelerations, dim=-1))

    def tensors(self) -> dict[str, Tensor]:
        """Return the coefficients of each target's equation."""
        return dict(zip(self.layout.targets, self.coefficients, strict=True))

    def restore(self, tensors: Mapping[str, Tensor]) -> None:
        """Take over the coefficients."""
        shapes = {name: (count,) for name, count in zip(self.layout.targets, self.counts(), strict=True)}
        own = take_tensors(tensors, shapes)
        self.coefficients = [own[name] for name in self.layout.targets]

    def counts(self) -> list[int]:
        """Return the number of coefficients of each target's equation."""
        return [len(terms) for terms in self._terms(torch.zeros(len(self.layout.features)))]

    def _changed(self) -> list[Tensor]:
        """Return the coefficients with what a hybrid has learned of them."""
        if self.changes is None:
            return self.coefficients
        pairs = zip(self.coefficients, self.changes, strict=True)
        return [own * (1.0 + 0.01 * change) for own, change in pairs]

    def _terms(self, features: Tensor) -> list[Terms]:
        return TERMS[self.layout.kind](features)

    def _known(self, features: Tensor) -> Tensor:
        if self.layout.kind in KNOWN:
            return KNOWN[self.layout.kind](features)
        return features.new_zeros(*features.shape[:-1], len(self.layout.targets))

    def _averages(self, examples: Examples, first: int, last: int) -> list[tuple[Tensor, Tensor]]:
        """Return terms (windows, terms) and accelerations (windows,) of every target, averaged along a segment."""
        features = examples.features[first : last - 1]
        increments = examples.targets[first : last - 1]  # the last sample of a segment has none
        wanted = increments / self.time_step - self._known(features)
        window = moving_window(self.settings.averaging, self.time_step)
        return [
            (moving_mean_of(window, torch.stack(terms)).T, moving_mean_of(window, target))
            for terms, target in zip(self._terms(features), wanted.T, strict=True)
        ]


def _solved(terms: Sequence[Tensor], targets: Sequence[Tensor]) -> Tensor:
    """Return the coefficients (terms,) of least squares over all segments.

    Raises:
        InputError: when no segment is as long as an averaging window.
    """
    design, target = torch.cat(list(terms)), torch.cat(list(targets))
    if not len(design):
        raise InputError(
            "no segment is as long as a window", "model.averaging", "shorten it, or record longer"
        )
    scale = design.square().mean(0).sqrt()
    scale = torch.where(scale > 0.0, scale, torch.ones_like(scale))
    # What does not move, or moves with something else, is found by the least coefficients.
    return torch.linalg.lstsq(design / scale, target[:, None], driver="gelsd").solution[:, 0] / scale
