"""A walk replayed on its map: run as a script, or cell by cell in a notebook.

python replay_a_walk.py MAP RECORDING
"""

# %% Open a map and replay a recording on it
import sys

import fieldwalk
import numpy as np

map_path, recording_path = sys.argv[1:3]
building = fieldwalk.BuildingMap.open(map_path)
replayed = fieldwalk.replay(building, recording_path)
print(f"{building.name()}: {len(replayed.fixes)} fixes in {np.ptp(replayed.time_ns) / 1e9:.0f} s")

# %% How far off was it at the waypoints, and was that what it said?
error_m, stated_m = replayed.waypoint_error_m[1:], replayed.radius_95_m[replayed.waypoint_fix[1:]]
print(f"median error {replayed.median_error_m:.2f} m")
print(f"{np.mean(error_m <= stated_m):.0%} of {len(error_m)} waypoints within the 95 % radius")

# %% The systems compared
for system in fieldwalk.systems():
    median_m = fieldwalk.replay(building, recording_path, system=system).median_error_m
    print(f"{system:>16} {median_m:6.2f} m")

# %% The magnetic field that the phone measured
recording = fieldwalk.read_recording(recording_path)
field = recording.get("uncalibrated_magnetic_field", recording.get("magnetic_field"))
strength_ut = np.sqrt(sum(field[axis].astype(float) ** 2 for axis in ("x_ut", "y_ut", "z_ut")))
print(f"field strength {strength_ut.min():.0f} to {strength_ut.max():.0f} µT in {len(field)} readings")

# %% The way walked, to plot: matplotlib's plt.plot(*replayed.position_m.T) draws it
walked_m = np.linalg.norm(np.diff(replayed.position_m, axis=0), axis=1).sum()
print(f"walked about {walked_m:.0f} m")
building.close()
