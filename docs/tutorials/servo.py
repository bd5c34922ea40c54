# %% [markdown]
# # A servo
#
# This tutorial diagnoses a geared servo.
# You record it, describe it, and ask which physics its simulator lacks.
# Here the recording is simulated, so that you can check the answer.
#
# ## The machine
#
# The servo has a brushed motor at 12 V behind a gear of 50.
# Its data sheet gives four numbers.
# The inertia is that of everything which turns with the joint, the motor's rotor included.

# %%
platform = {
    "kind": "joint",
    "inertia": 0.0128,  # kg·m²
    "motor": {
        "resistance": 2.3,  # Ω
        "torque_constant": 0.0234,  # N·m/A
        "gear_ratio": 50.0,
    },
}

# %% [markdown]
# Real gears have friction, and the data sheet says nothing about it.
# So we conceal **0.3 N·m of Coulomb friction** in the simulated machine.

# %%
import numpy as np
import pandas as pd

FRICTION = 0.3  # N·m, concealed
RATE = 200  # Hz, of the log
STEPS = 10  # of the simulation, from sample to sample


def drive(voltage):
    """Return position (rad) and velocity (rad/s) at each sample.

    A voltage is held from its sample to the next.
    """
    inertia, motor = platform["inertia"], platform["motor"]
    constant = motor["gear_ratio"] * motor["torque_constant"]  # N·m/A
    step = 1 / (RATE * STEPS)
    braking = step * FRICTION / inertia  # it stops the axis, never reverses it
    position = velocity = 0.0
    samples = []
    for volts in voltage:
        samples.append((position, velocity))
        for _ in range(STEPS):
            current = (volts - constant * velocity) / motor["resistance"]
            velocity += step * constant * current / inertia
            velocity = np.sign(velocity) * max(abs(velocity) - braking, 0.0)
            position += step * velocity
    return np.array(samples).T


# %% [markdown]
# ## The recording
#
# A recording is a table with one row per sample.
# The column `run` names the trial, and `t` is the time in seconds.
# A joint needs `position`, and `voltage`, `effort` or `position_command`.
# A recorded `velocity` is better than a derived one.
#
# Six trials of eight seconds are plenty.
# Each is a sum of eight sines at random frequencies.
# The sensors add noise: 0.2 mrad on the position, 0.02 rad/s on the velocity.

# %%
random = np.random.default_rng(seed=1)
time = np.arange(8 * RATE) / RATE


def trial(number):
    frequencies = random.uniform(0.2, 6.0, 8)  # Hz
    phases = random.uniform(0, 2 * np.pi, 8)
    waves = np.sin(2 * np.pi * frequencies * time[:, None] + phases)
    voltage = 1.5 * waves.sum(axis=1)
    position, velocity = drive(voltage)
    columns = {
        "run": f"trial_{number}",
        "t": time,
        "position": position + random.normal(0, 2e-4, time.size),
        "velocity": velocity + random.normal(0, 0.02, time.size),
        "voltage": voltage,
    }
    return pd.DataFrame(columns)


log = pd.concat(map(trial, range(6)), ignore_index=True)
log.to_parquet("log.parquet")
log.head()

# %% [markdown]
# ## The question
#
# `simgap.diagnose` takes the log and the platform.
# The log may be a path, a DataFrame or a dictionary of columns.
# The platform may be a path, a dictionary or a dataclass.

# %%
import simgap

answer = simgap.diagnose("log.parquet", platform=platform)
print(answer.verdict)

# %% [markdown]
# The verdict is `missing_physics`: no correction of the data sheet's numbers explains this log.
# Each effect has a name, a probability and a sentence.

# %%
for effect in answer.effects:
    print(f"{effect.name}, probability {effect.probability:.2f}")
    print(effect.statement)

# %% [markdown]
# The value agrees with the 0.3 N·m that we concealed.
#
# Some trials were held out: nothing was fitted to them.
# On these, the error falls almost to the noise of the sensors.

# %%
print(f"gap closed: {answer.fit.gap_closed:.0%}")

# %% [markdown]
# A gap closed of 100 % means that only noise is left.
#
# ## The page
#
# The page shows the evidence: where the simulator failed, what was tried, and how sure the answer is.
# It opens without a network.
# `save` writes it as `answer/report.html`, beside the simulator that now has the friction.

# %%
answer.save("answer")

# %% [markdown]
# ## The simulator
#
# Load it, and drive it with the voltages of the first trial.
# A state holds position and velocity. A rollout returns the state at every sample.

# %%
machine = simgap.load_simulator("answer/simulator")
first = log[log["run"] == "trial_0"]
voltages = first[list(machine.command_names)].to_numpy()
start = first[list(machine.state_names)].to_numpy()[0]
step = {"dt": 1 / RATE, "substeps": STEPS}
after = machine.rollout(start, voltages, **step)
after.shape

# %% [markdown]
# The rollout knows only the first sample, and the voltages.
# Compare it with the log, and with the simulator as it was before.

# %%
import matplotlib.pyplot as plt

before = answer.nominal.rollout(start, voltages, **step)
figure, axes = plt.subplots(figsize=(7, 3))
axes.plot(time, first["position"], "k", label="log")
axes.plot(time, before[:-1, 0], "C1", label="simulator before")
axes.plot(time, after[:-1, 0], "C0--", label="simulator after")
axes.set(xlabel="time (s)", ylabel="position (rad)")
_ = axes.legend()

# %% [markdown]
# On the command line the same question is:
#
# ```text
# simgap diagnose --config-dir my platform=arm \
#     recording=log.parquet output=answer
# ```
#
# Here `my/platform/arm.yaml` holds the platform.
#
# ## What next
#
# - [A log that goes wrong](wrong_log.md) shows what a sign error looks like.
# - [The Python API](api.md) shows what else the answer and the simulator can do.
# - [Joint effects](../effects.md#joint) lists everything that can be named.

# %% tags=["remove-cell"]
believed = [each.name for each in answer.effects if each.probability > 0.5]
logged = first["position"].to_numpy()
errors = [np.abs(each[:-1, 0] - logged).max() for each in (before, after)]
assert (answer.verdict, believed) == ("missing_physics", ["coulomb_friction"])
assert errors[1] < 0.2 * errors[0]
