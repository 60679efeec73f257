"""Named regressors of a touch's position and strength."""

from sklearn.compose import TransformedTargetRegressor
from sklearn.gaussian_process import GaussianProcessRegressor
from sklearn.gaussian_process.kernels import RBF, ConstantKernel, WhiteKernel
from sklearn.kernel_ridge import KernelRidge
from sklearn.neighbors import KNeighborsRegressor
from sklearn.pipeline import Pipeline
from sklearn.preprocessing import StandardScaler

from ..cores import count_cores
from .components import Components
from .networks import COMPONENTS, NetworkRegressor

WIDTH = 0.3
"""gamma of the kernel exp(-gamma |x - x'|²) of components that vary by 1 in sum."""


def kernel_ridge(alpha: float = 1e-4, gamma: float = WIDTH) -> Pipeline:
    """Kernel ridge regression of standardised targets on components."""
    ridge = KernelRidge(kernel="rbf", gamma=gamma).set_params(alpha=alpha)
    return _on_components(TransformedTargetRegressor(ridge, transformer=StandardScaler()))


def gaussian_process() -> Pipeline:
    """A Gaussian process of one kernel for all targets; its hyper-parameters have most evidence."""
    kernel = ConstantKernel(10.0, (1e-3, 1e6)) * RBF(0.1, (1e-4, 1e3)) + WhiteKernel(
        1e-1, (1e-6, 1e2)
    )
    return _on_components(GaussianProcessRegressor(kernel, normalize_y=True, random_state=0))


def network() -> Pipeline:
    """A network of standardised targets on components that all vary alike."""
    regressor = TransformedTargetRegressor(NetworkRegressor(), transformer=StandardScaler())
    alike = [("components", Components(COMPONENTS)), ("scale", StandardScaler())]
    return Pipeline([*alike, ("regress", regressor)])


def neighbours(count: int = 10) -> Pipeline:
    """The mean of the nearest sweeps, a baseline."""
    count_cores()
    return _on_components(KNeighborsRegressor(count, weights="distance", algorithm="brute"))


def _on_components(regressor) -> Pipeline:
    return Pipeline([("components", Components()), ("regress", regressor)])
