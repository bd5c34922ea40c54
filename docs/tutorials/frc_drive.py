# %% [markdown]
# # An FRC swerve drive
#
# This tutorial diagnoses the drive of a competition robot.
# The robot has four swerve modules, each with a drive motor and a steering motor.
#
# ## The machine
#
# Write down what you know of the robot.
# Masses come from the scale, and ratios from the module's data sheet.
# The motor's numbers come from its data sheet.

# %%
from pathlib import Path

ROBOT = """\
kind: swerve
mass: 54.0                     # kg, with bumpers and battery
inertia: 5.1                   # kg·m², about the vertical axis
module_positions:              # m, x forward, y left
  - [0.27, 0.27]
  - [0.27, -0.27]
  - [-0.27, 0.27]
  - [-0.27, -0.27]
wheel_radius: 0.0508           # m
drive:
  gear_ratio: 6.75
  motor: &neo                  # V, rad/s, N·m, A
    nominal_voltage: 12.0
    free_speed: 594.4
    stall_torque: 2.6
    stall_current: 105.0
steer:
  gear_ratio: 21.428571
  motor: *neo
  inertia: 0.03                # kg·m², at the module
"""
_ = Path("robot.yaml").write_text(ROBOT)

# %% [markdown]
# ## The recording
#
# For a robot of your own, log these columns for every module:
# `drive_voltage`, `steer_voltage`, `drive_velocity`, `steer_velocity` and `steer_angle`.
# The chassis velocities are optional.
# The [contract](../contract.md#recording) lists the units.
#
# Here one of the project's own plants is driven.
# A plant simulates finer than the diagnosis does: tyres slip, encoders count, and samples are lost.
# We conceal one effect in it: **0.35 N·m of Coulomb friction at each driven wheel**.

# %%
import shlex
import subprocess
import sys

RECORD = """
-m simgap.stages record
platform=swerve_robot record=swerve_robot dataset.source=reality
record.runs=8 record.duration=6
'record.effects={coulomb_friction@drive: {level: 0.35}}'
tracking=none output=drive
"""
_ = subprocess.run([sys.executable, *shlex.split(RECORD)], check=True)

# %% [markdown]
# This is the command `simgap record` with its options.
#
# The eight runs weave, spin, shuttle and curve.
# Each motion occurs twice, so that one of the two can be held out.

# %%
import pandas as pd

log = pd.read_parquet("drive/recording.parquet")
log.groupby("run", sort=False)["t"].agg(["count", "max"])

# %% [markdown]
# ## The question

# %%
import simgap

answer = simgap.diagnose("drive/recording.parquet", platform="robot.yaml")
answer

# %% [markdown]
# The name and the value are those that we concealed.
# A swerve drive has three groups: `drive`, `steer` and `chassis`.
# `acts_on` says where an effect belongs.

# %%
friction = next(effect for effect in answer.effects if effect.name == "coulomb_friction")
level = friction.parameters["level"]
print(f"{friction.name} ({friction.acts_on}): {level.value:.3f} N·m")

# %% [markdown]
# ## What to do with it
#
# In a robot program this friction is the static term of the feedforward.
# A wheel torque becomes a motor voltage by the gear and the motor:

# %%
motor_torque = level.value / 6.75
print(f"kS = {12.0 * motor_torque / 2.6:.3f} V")

# %% [markdown]
# ## When the answer is unsure
#
# - Battery sag needs a recorded `battery_voltage`, or full-throttle runs.
# - Friction needs slow driving, and starts from rest.
# - `wheel_slip` needs hard acceleration.
# - `answer.ambiguous` lists effects that your log cannot tell apart. It names the manoeuvre that would.
#
# The [swerve effects](../effects.md#swerve) list the manoeuvre for every name.

# %% tags=["remove-cell"]
assert answer.verdict == "missing_physics"
assert (friction.name, friction.acts_on) == ("coulomb_friction", "drive")
assert abs(level.value - 0.35) < 0.05
