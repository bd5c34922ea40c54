# %% [markdown]
# # A log that goes wrong
#
# Most bad answers come from bad logs.
# A sign is reversed, an angle is in degrees, or a column is missing.
# This tutorial breaks a good log in three ways, and shows what `simgap` says.
#
# ## A good log
#
# The machine is a pendulum with a torque at its joint.
# Its simulator lacks nothing, so a good log must give the verdict `none`.

# %%
import numpy as np
import pandas as pd

platform = {
    "kind": "joint",
    "inertia": 0.02,  # kg·m²
    "gravity_torque": 0.8,  # N·m; zero position hangs down
}
RATE = 200  # Hz, of the log
STEPS = 10  # of the simulation, from sample to sample
random = np.random.default_rng(seed=2)
time = np.arange(8 * RATE) / RATE


def swing(effort):
    """Return position (rad) and velocity (rad/s) at each sample.

    A torque (N·m) is held from its sample to the next.
    """
    step, position, velocity = 1 / (RATE * STEPS), 0.0, 0.0
    samples = []
    for torque in effort:
        samples.append((position, velocity))
        for _ in range(STEPS):
            gravity = platform["gravity_torque"] * np.sin(position)
            velocity += step * (torque - gravity) / platform["inertia"]
            position += step * velocity
    return np.array(samples).T


def trial(number):
    frequencies = random.uniform(0.2, 4.0, 6)  # Hz
    phases = random.uniform(0, 2 * np.pi, 6)
    waves = np.sin(2 * np.pi * frequencies * time[:, None] + phases)
    effort = 0.12 * waves.sum(axis=1)
    position, velocity = swing(effort)
    columns = {
        "run": f"trial_{number}",
        "t": time,
        "position": position + random.normal(0, 2e-4, time.size),
        "velocity": velocity + random.normal(0, 0.02, time.size),
        "effort": effort,
    }
    return pd.DataFrame(columns)


good = pd.concat(map(trial, range(4)), ignore_index=True)

# %%
import simgap

answer = simgap.diagnose(good, platform=platform)
print(answer.verdict)

# %% [markdown]
# `none` means: the simulator already fits this log, to the noise of the sensors.
#
# ## A wrong sign
#
# Now the driver of the motor counts torque the other way round.

# %%
wrong_sign = good.assign(effort=-good["effort"])
answer = simgap.diagnose(wrong_sign, platform=platform)
print(answer.verdict)
for found in answer.contradictions:
    print(f"{found.column}: {found.evidence}. {found.remedy}")

# %% [markdown]
# The verdict is `contradiction`, and no effect is named.
# The machine accelerates against its command, and no physics in the catalogue does that.
# The page opens with the same sentences: the column, the evidence and the remedy.
# Mend the sign in the log, and ask again.

# %% tags=["remove-cell"]
assert (answer.verdict, answer.effects) == ("contradiction", ())
assert answer.contradictions[0].column == "effort"

# %% [markdown]
# ## Degrees where radians belong
#
# Many servos log degrees. The contract wants radians.

# %%
degrees = good.assign(position=np.rad2deg(good["position"]), velocity=np.rad2deg(good["velocity"]))
answer = simgap.diagnose(degrees, platform=platform)
print(answer.verdict)
print(*answer.warnings, sep="\n")

# %% tags=["remove-cell"]
assert (answer.verdict, answer.effects) == ("contradiction", ())
assert any("degrees" in warning for warning in answer.warnings)

# %% [markdown]
# Position and velocity agree with each other, but not with the effort.
# The check finds that degrees would explain it, and says how to mend the log.
# Say the units, and the log is good again.

# %%
answer = simgap.diagnose(degrees, platform=platform, units={"position": "deg", "velocity": "deg/s"})
print(answer.verdict)

# %% tags=["remove-cell"]
assert answer.verdict == "none"

# %% [markdown]
# In a Parquet file each column may declare its unit.
# The [contract](../contract.md#recording) says how.
#
# ## A column that is missing
#
# Some logs cannot be used at all.
# Then there is no answer, but one line: what is wrong, where, and what to do.

# %%
try:
    simgap.diagnose(good.drop(columns="effort"), platform=platform)
except simgap.InputError as error:
    print(error)

# %% [markdown]
# The command line prints the same line and ends with exit code 2.
#
# ## A list to go through
#
# Check these before you doubt the physics:
#
# - Does each velocity equal the slope of its position?
# - Does a positive command accelerate the machine forwards?
# - Are angles in radians, and times in seconds?
# - Do all columns come from one clock?
# - Is a velocity filtered? A filter makes it late.
# - Are there two runs of every sort of motion? One of them is held out.
