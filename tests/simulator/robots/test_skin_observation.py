"""Readings of a skin in the observations of a Gymnasium environment."""

import gymnasium
import mujoco
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from rcskin.simulator.sweeps import InputError

from .conftest import model_with, small_scene

FINGER = (
    '<body name="finger" pos="0 0 .011"><joint name="down" type="slide" axis="0 0 -1" '
    'damping="5" range="-.02 .02"/><geom name="tip" type="sphere" size=".01" mass=".05"/></body>'
)
SIZE = 9


class PressingFinger(gymnasium.Env):
    """A finger that is pushed onto a skin by the force of the action, N."""

    metadata = {"render_modes": []}

    def __init__(self):
        self.model = model_with(touching=FINGER)
        self.data = mujoco.MjData(self.model)
        self.action_space = gymnasium.spaces.Box(-1, 1, (1,), np.float32)
        self.observation_space = gymnasium.spaces.Box(-np.inf, np.inf, (1,), np.float64)

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        mujoco.mj_resetData(self.model, self.data)
        self.data.qpos[0] = self.np_random.uniform(-1e-3, 0)
        mujoco.mj_forward(self.model, self.data)
        return self.data.qpos.copy(), {}

    def step(self, action):
        self.data.qfrc_applied[0] = action[0]
        mujoco.mj_step(self.model, self.data, nstep=5)
        return self.data.qpos.copy(), 0.0, False, False, {}


@pytest.fixture
def env(skin_on):
    bare = PressingFinger()
    return skin_on(bare.model).observed(bare)


@pytest.mark.filterwarnings("ignore:.*different from the unwrapped version")
@pytest.mark.filterwarnings("ignore:.*value is -?infinity")
@pytest.mark.parametrize("changes", [False, True])
def test_gymnasium_accepts_the_environment(skin_on, changes):
    bare = PressingFinger()
    check_env(skin_on(bare.model).observed(bare, changes=changes), skip_render_check=True)


def test_observations_have_names_units_and_no_nan(env):
    observation, _ = env.reset(seed=1)
    assert set(observation) == {"observation", "skin"}
    assert observation["skin"].shape == (SIZE,) and np.isfinite(observation["skin"]).all()
    assert env.names[0] == "Rs left 1000 Hz" and env.units[0] == "ohm"
    assert len(env.names) == len(env.units) == SIZE


def test_a_push_is_seen_and_a_seed_repeats_it(skin_on):
    bare = PressingFinger()
    env = skin_on(bare.model).observed(bare, "touch", changes=True)
    pushed = []
    for _ in range(2):
        env.reset(seed=4)
        pushed.append([env.step(np.ones(1, np.float32))[0]["touch"] for _ in range(20)])
    assert np.array_equal(*pushed) and env.units == ("1",) * SIZE
    capacitance = env.names.index("Cp left 1000 Hz")
    assert pushed[0][-1][capacitance] > 2e-3


def test_a_skin_of_another_model_and_a_taken_name_are_refused(skin_on):
    bare = PressingFinger()
    with pytest.raises(InputError, match="must be on `env.unwrapped.model`"):
        skin_on(PressingFinger().model).observed(bare)
    once = skin_on(bare.model).observed(bare)
    with pytest.raises(InputError, match="have a 'skin' already"):
        skin_on(bare.model, scene=small_scene()).observed(once)


def test_gymnasium_s_own_environments_can_carry_a_skin():
    pytest.importorskip("imageio", reason="imageio is not installed: pip install '.[mujoco]'")
    assert gymnasium.make("Pusher-v5").unwrapped.model.ngeom > 0
