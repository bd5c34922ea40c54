"""The learned models that are solved in closed form: what a hybrid can be built around."""

from simgap.models.contract import DynamicsModel
from simgap.models.linear import LinearModel
from simgap.models.narx import NarxModel
from simgap.models.rbf import RadialBasisModel
from simgap.models.state_space import StateSpaceModel
from simgap.models.transfer_function import TransferFunctionModel
from simgap.models.white_box import WhiteBoxModel

CLOSED_FORM: dict[str, type[DynamicsModel]] = {
    "linear": LinearModel,
    "state_space": StateSpaceModel,
    "white_box": WhiteBoxModel,
    "transfer_function": TransferFunctionModel,
    "narx": NarxModel,
    "rbf": RadialBasisModel,
}
