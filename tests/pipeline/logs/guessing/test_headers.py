"""Headers as hobby and lab logs have them: the quantity and the unit that a name says, and what no name says."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from simgap.logs.guess import guess
from simgap.logs.guessing.words import said_by
from simgap.logs.header_units import unit_in
from simgap.logs.proposal import SURE
from simgap.logs.tabular import log_of_table
from simgap.recordings.units import conversion
from tests.pipeline.logs.guessing.naming import motion

# header, quantity, unit as the contract spells it; a dash where there is none, and * before what is commanded
HEADERS = """
coil_V                  voltage       V
winding_V               voltage       V
Winding voltage [V]     voltage       V
motor_V                 voltage       V
terminal_voltage_V      voltage       V
armature_mV             voltage       mV
u_V                     voltage       V
cmd_V                   *voltage      V
coilV                   voltage       V
MotorVoltage(V)         voltage       V
Voltage, V              voltage       V
joint_voltage_V_1       voltage       -
battery_V               battery       V
batt_v                  battery       V
vbat_mV                 battery       mV
supply_V                battery       V
Vbus [V]                battery       V
duty_pct                duty          percent
throttle_percent        duty          percent
current_A               current       A
motor_current_mA        current       mA
i_A                     current       A
iq_A                    current       A
I_motor [A]             current       A
torque_Nm               effort        N·m
Torque (N.m)            effort        N·m
tau_mNm                 effort        mN·m
servo_torque_Ncm        effort        N·cm
torque (kg.cm)          effort        kgf·cm
torque_n_m              effort        N·m
load_N                  effort        N
force_N                 effort        N
enc_deg                 position      deg
encoder_rad             position      rad
encoder [ticks]         position      ticks
AngleDeg                position      deg
theta [rad]             position      rad
q_rad[0]                position      rad
pos_rev                 position      rev
Position (rot)          position      rev
shaft angle, deg        position      deg
carriage_mm             position      mm
slide_position_m        position      m
elevator_height_in      position      in
pos_n_m                 position      m
setpoint_deg            *position     deg
target_pos_rad          *position     rad
wheel_speed_rpm         velocity      rpm
rpm1                    velocity      rpm
motor_rpm_1             velocity      rpm
omega_rad_s             velocity      rad/s
omega [rad/s]           velocity      rad/s
w_rad_s                 velocity      rad/s
vel_dps                 velocity      deg/s
speed (deg/s)           velocity      deg/s
speed_ms                velocity      m/s
carriage_mm_s           velocity      mm/s
drive_in_s              velocity      in/s
velocity_fps            velocity      ft/s
speed_sp_rpm            *velocity     rpm
acc_x_g                 acceleration  g
acc_y_g                 acceleration  g
accel_z_g               acceleration  g
acc_g_x                 acceleration  g
accelerometer_x_mg      acceleration  mg
ax_g                    acceleration  g
ax_m_s2                 acceleration  m/s²
AccX [m/s^2]            acceleration  m/s²
accX                    acceleration  -
gyr_x_dps               body_rate     deg/s
gyro_y_deg_s            body_rate     deg/s
gyro_z_rad_s            body_rate     rad/s
GyroX (deg/s)           body_rate     deg/s
gyro_rads_x             body_rate     rad/s
time_s                  -             s
t_s                     -             s
t_us                    -             us
Time (ms)               -             ms
timestamp_ns            -             ns
temp_C                  temperature   °C
motor_temp_degC         temperature   °C
winding_temp_C          temperature   °C
phase_U                 -             -
phase_V                 -             -
motor_A                 -             -
coil_A                  -             -
channel_A               -             -
battery_current_A       -             A
mass_g                  -             -
gain_g                  -             -
count_N                 -             -
motor_m                 -             -
kp_s                    -             -
camera_fps              -             -
temp_F                  -             °F
power_W                 -             W
rate_hz                 -             Hz
alpha_rad_s2            -             rad/s²
omega_dot_rad_s2        -             rad/s²
speed [V]               -             V
error_deg               -             deg
latency_us              -             us
status                  -             -
rudder                  -             -
items                   -             -
"""
TABLE = [line.rsplit(maxsplit=2) for line in HEADERS.strip().splitlines()]


@pytest.mark.parametrize(("header", "quantity", "unit"), TABLE, ids=[row[0] for row in TABLE])
def test_what_a_header_says(header: str, quantity: str, unit: str) -> None:
    said, found = said_by(header), unit_in(header)
    assert ("" if said.other else said.quantity) == quantity.strip("*-")
    assert said.commanded == quantity.startswith("*")
    assert (found or "-") == unit or conversion(found or "") == conversion(unit) is not None


def test_a_coil_voltage_drives_a_joint_and_channels_do_not() -> None:
    time, position, velocity = motion(np.random.default_rng(3), 700)
    frame = pd.DataFrame({"t_s": time, "enc_deg": np.rad2deg(position), "omega_dps": np.rad2deg(velocity),
                          "coil_V": 6.0 * np.sign(velocity) + velocity, "motor_A": 0.1 * velocity,
                          "acc_x_g": np.gradient(velocity), "lidar_m": 50.0 * position})  # fmt: skip
    proposal = guess(log_of_table(frame, Path("log.csv"), "table"), None)
    assert proposal.is_sure
    chosen = {column: (found.source.signal, found.source.unit) for column, found in proposal.columns.items()}
    assert chosen == {
        "t": ("t_s", "s"),
        "position": ("enc_deg", "deg"),
        "velocity": ("omega_dps", "deg/s"),
        "voltage": ("coil_V", "V"),
    }
    assert all(found.confidence >= SURE for found in proposal.columns.values())
