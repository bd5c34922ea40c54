# %% [markdown]
# # A quadrotor
#
# This tutorial diagnoses a racing quadrotor, and flies the simulator that comes out of it.
#
# ## The recording
#
# A flight log needs body rates, and motor speeds or motor commands.
# Drag, wind and ground effect show with position, attitude and velocity only.
# `specific_force` and `battery_voltage` help.
#
# Here one of the project's own plants is flown.
# It has rotors by blade elements, a battery with a voltage behind a resistance, and noisy sensors.
# We conceal one effect: **rotor drag of 0.35 1/s**.
# At hover speed of the rotors, each m/s of airspeed then costs 0.35 m/s² of lateral acceleration.

# %%
import shlex
import subprocess
import sys

RECORD = """
-m simgap.stages record
platform=racer record=embedded dataset.source=reality
record.runs=6 record.duration=8 'record.effects={rotor_drag: 0.35}'
tracking=none output=flights
"""
_ = subprocess.run([sys.executable, *shlex.split(RECORD)], check=True)

# %% [markdown]
# This is the command `simgap record` with its options.
#
# ## The question
#
# The package brings the platform file of this racer, so its name is enough.
# For a machine of your own, [write one](../how_to/platform.md).

# %%
import simgap

answer = simgap.diagnose("flights/recording.parquet", platform="racer")
answer

# %% [markdown]
# ## The simulator
#
# `answer.simulator` is the racer with rotor drag in it.
# A state holds position, attitude, velocity and body rates.
# `machine.state` makes one: here at 10 m height, at 8 m/s forwards.

# %%
machine = answer.simulator
print(machine)
start = machine.state(position_z=10.0, velocity_x=8.0)

# %% [markdown]
# A quadrotor is driven by four motor commands from 0 to 1.
# Let it hover for half a second: each rotor carries a quarter of the weight.

# %%
import numpy as np

racer = machine.platform
hover = np.sqrt(racer.mass * racer.gravity / (4 * racer.thrust_coefficient)) / racer.motor_speed_max
commands = np.full((50, 4), hover)
after = machine.rollout(start, commands, dt=0.01)
before = answer.nominal.rollout(start, commands, dt=0.01)
speed = machine.state_names.index("velocity_x")
print(f"without drag {before[-1, speed]:.2f} m/s after 0.5 s")
print(f"with drag    {after[-1, speed]:.2f} m/s after 0.5 s")

# %% [markdown]
# Without drag the racer keeps its 8 m/s.
# With drag it loses some 16 % of it, as the real machine does.
#
# A batch of machines is one more dimension, in front:

# %%
batch = machine.rollout(np.tile(start, (100, 1)), commands, dt=0.01)
print(batch.shape)

# %% [markdown]
# ## What next
#
# - [Racing](../racing.md) trains a policy in this simulator.
# - [Quadrotor effects](../effects.md#quadrotor) lists everything that can be named.

# %% tags=["remove-cell"]
drag = next(each for each in answer.effects if each.name == "rotor_drag")
assert drag.probability > 0.5
assert abs(drag.parameters["coefficient"].value - 0.35) < 0.03
assert after[-1, speed] < 0.9 * before[-1, speed]
assert batch.shape == (100, 51, 13)
