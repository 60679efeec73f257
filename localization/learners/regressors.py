"""Named regressors of a touch's position and strength."""

from sklearn.compose import TransformedTargetRegressor
from sklearn.kernel_ridge import KernelRidge
from sklearn.pipeline import Pipeline
from sklearn.preprocessing import StandardScaler

from .components import Components
from .networks import COMPONENTS, NetworkRegressor

WIDTH = 0.3
"""gamma of the kernel exp(-gamma |x - x'|²) of components that vary by 1 in sum."""


def kernel_ridge(alpha: float = 1e-4, gamma: float = WIDTH) -> Pipeline:
    """Kernel ridge regression of standardised targets on components."""
    ridge = KernelRidge(kernel="rbf", gamma=gamma).set_params(alpha=alpha)
    regressor = TransformedTargetRegressor(ridge, transformer=StandardScaler())
    return Pipeline([("components", Components()), ("regress", regressor)])


def network() -> Pipeline:
    """A network from components of unit variance to standardised targets."""
    regressor = TransformedTargetRegressor(NetworkRegressor(), transformer=StandardScaler())
    scaled = [("components", Components(COMPONENTS)), ("scale", StandardScaler())]
    return Pipeline([*scaled, ("regress", regressor)])
