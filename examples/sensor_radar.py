"""The pipeline `sensor_radar` in twenty lines: simulate a walk, track it, print where the person was."""

from dataclasses import replace

from echofuse.pipeline import process_recording
from echofuse.simulation.scene import sensor_radar_scene
from echofuse.simulation.sensor_radar import case_study_people, simulate
from echofuse.site import example_site

site = example_site("sensor_radar")
recording = simulate(sensor_radar_scene(), case_study_people(1), duration_s=3.0, seed=1)
result = process_recording(replace(recording, site_toml=site.to_toml()), site)

for frame, time_us in enumerate(result.frame_time_us):
    for track in result.tracks[result.tracks["frame"] == frame]:
        print(
            f"{time_us * 1e-6:4.1f} s  person {track['id']} at ({track['x_m']:5.2f}, {track['y_m']:4.2f}) m"
        )
print(f"root mean square error {result.metrics['rmse_m']:.2f} m")
