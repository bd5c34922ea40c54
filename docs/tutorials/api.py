# %% [markdown]
# # From a log to a simulator in Python
#
# This tutorial uses `simgap` from a program of your own.
# It diagnoses a pendulum, rolls the diagnosed simulator out, and flies an episode of a race in Gymnasium.
# Install it with `pip install 'simgap[race]'`.
#
# ## A log
#
# A pendulum hangs from a motor that applies a torque.
# We simulate it here with NumPy, and conceal 0.15 N·m of Coulomb friction.

# %%
import numpy as np

INERTIA, GRAVITY_TORQUE = 0.05, 1.0  # kg·m², N·m: what we know
FRICTION = 0.15  # N·m: what we conceal
RATE, FINE = 200, 10  # samples per second, steps of the simulation per sample
random = np.random.default_rng(seed=0)


def swing(effort):
    """Return positions (rad) and velocities (rad/s) for torques (runs, samples) in N·m."""
    step = 1 / (RATE * FINE)
    position, velocity = np.zeros((2, len(effort)))
    path = []
    for torque in effort.T:
        path.append((position, velocity))
        for _ in range(FINE):
            load = torque - GRAVITY_TORQUE * np.sin(position)
            free = velocity + step * load / INERTIA
            slower = np.abs(free) - step * FRICTION / INERTIA
            velocity = np.sign(free) * np.maximum(slower, 0.0)  # friction reverses nothing
            position = position + step * velocity
    return np.array(path).transpose(1, 2, 0)


# %% [markdown]
# Six runs of eight seconds, each a sum of sines at random frequencies.
# The sensors add noise.
# A recording may be a file, a DataFrame or, as here, a dictionary of columns.
# Every column is in SI units; `run` names the run, and `t` is the time.

# %%
runs, time = 6, np.arange(8 * RATE) / RATE
frequencies = random.uniform(0.2, 4.0, (runs, 8, 1))
phases = random.uniform(0, 2 * np.pi, (runs, 8, 1))
effort = 0.35 * np.sin(2 * np.pi * frequencies * time + phases).sum(axis=1)
position, velocity = swing(effort)
log = {
    "run": np.repeat([f"run_{number}" for number in range(runs)], time.size),
    "t": np.tile(time, runs),
    "position": (position + random.normal(0, 2e-4, position.shape)).ravel(),
    "velocity": (velocity + random.normal(0, 0.02, velocity.shape)).ravel(),
    "effort": effort.ravel(),
}

# %% [markdown]
# ## The diagnosis
#
# The platform holds what you know of the machine.
# `diagnose` does what `simgap diagnose` does on the command line, and writes nothing.

# %%
import simgap

platform = {"kind": "joint", "inertia": INERTIA, "gravity_torque": GRAVITY_TORQUE}
answer = simgap.diagnose(log, platform)
answer

# %% [markdown]
# The fields of the answer are those of `diagnosis.json`.

# %%
friction = answer.effects[0]
print(friction.name, friction.probability)
print(friction.parameters["level"])
print(answer.fit.gap_closed)

# %% [markdown]
# `settings` changes what the configuration says, with the same keys.
# Here the diagnosis may find two effects only, and two runs of your choice are held out.

# %%
narrow = simgap.diagnose(
    log,
    platform,
    settings={
        "gap": {"effects": ["coulomb_friction", "viscous_friction"]},
        "dataset": {"split": {"holdout": ["run_4", "run_5"]}},
    },
)
print(narrow.fit.held_out_runs)

# %% [markdown]
# `save` writes the simulator, the page and the evidence into a folder.
# `report` writes the page alone.

# %%
answer.save("answer")
answer.report("page.html")

# %% [markdown]
# ## The simulator
#
# A state is an array whose last dimension has the entries `state_names`.
# A command has the entries `command_names`.
# All dimensions before are batches.

# %%
machine = simgap.load_simulator("answer/simulator")
print(machine)
print(machine.state_names, machine.command_names, dict(machine.units))

# %% [markdown]
# Roll out all runs at once, from their first samples.
# A rollout holds the states at every sample: one more than there are commands.

# %%
start = np.stack([position[:, 0], velocity[:, 0]], axis=-1)
commands = effort[..., None]
after = machine.rollout(start, commands, dt=1 / RATE, substeps=FINE)
before = answer.nominal.rollout(start, commands, dt=1 / RATE, substeps=FINE)
print(start.shape, commands.shape, after.shape)

# %%
import matplotlib.pyplot as plt

figure, axes = plt.subplots(figsize=(7, 3))
axes.plot(time, position[0], "k", label="log")
axes.plot(time, before[0, :-1, 0], "C1", label="simulator before")
axes.plot(time, after[0, :-1, 0], "C0--", label="simulator after")
axes.set(xlabel="time (s)", ylabel="position (rad)")
_ = axes.legend()

# %% [markdown]
# `step` advances by one time step, for a controller in the loop.
# Some effects remember: a lag, play in a gear, a delay.
# Give `step` a `Memory` to carry that from call to call.
# Here a controller holds the pendulum at 0.5 rad.

# %%
memory, state = simgap.Memory(), machine.state()
for _ in range(2 * RATE):
    weight = GRAVITY_TORQUE * np.sin(state[0])
    torque = 4.0 * (0.5 - state[0]) - 0.5 * state[1] + weight
    state = machine.step(state, np.array([torque]), 1 / RATE, memory, substeps=FINE)
print(f"{state[0]:.3f} rad")

# %% [markdown]
# Friction lets it rest some way from 0.5 rad.
#
# Tensors go in and out as well, and keep their gradients.
# So you can fit a command, or train a policy, through a rollout.

# %%
import torch

push = torch.full((20, 1), 0.5, dtype=torch.float64, requires_grad=True)
end = machine.rollout(torch.from_numpy(machine.state()), push, dt=1 / RATE)[-1, 0]
end.backward()
print(push.grad[:3, 0])

# %% [markdown]
# ## The catalogue
#
# `catalogue` lists every effect that can be named.
# `build_simulator` builds a machine from a platform and effects of your choice.

# %%
print([effect.key for effect in simgap.catalogue("joint")][:5])
quadrotor = simgap.build_simulator("racer", {"rotor_drag": {"coefficient": 0.3}})
print(quadrotor)

# %% [markdown]
# ## A race
#
# A quadrotor's simulator is a Gymnasium environment, too.
# The simulator may be a folder, a machine, or the name of a platform.
# The first step compiles the simulator.

# %%
import gymnasium

race = gymnasium.make(
    "simgap/Race-v0",
    simulator=quadrotor,
    track="tiny",
    settings={"flying": {"substeps": 2}},  # fewer integration steps, compiled sooner
)
hover = np.zeros(4, np.float32)
seen, _ = race.reset(seed=0)
total, steps, over = 0.0, 0, False
while not over:
    seen, reward, terminated, truncated, _ = race.step(hover)
    total, steps, over = total + reward, steps + 1, terminated or truncated
print(f"{steps} steps, reward {total:.2f}")

# %% [markdown]
# A policy that hovers flies past no gate.
# [Racing](../racing.md) says how to train one that races.

# %% tags=["remove-cell"]
believed = [effect.name for effect in answer.effects if effect.probability > 0.5]
assert (answer.verdict, believed) == ("missing_physics", ["coulomb_friction"])
assert abs(friction.parameters["level"].value - FRICTION) < 0.02 * FRICTION
assert set(narrow.fit.held_out_runs) == {"run_4", "run_5"}
errors = [np.abs(states[:, :-1, 0] - position).max() for states in (before, after)]
assert errors[1] < 0.2 * errors[0]
assert (push.grad > 0).all()
