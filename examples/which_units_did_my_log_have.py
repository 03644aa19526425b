"""Which units did my log have, and how is that known.

Headers can be wrong: radians under `[°]`, Kelvin under `[°C]`, motor-side channels. Units are
determined from the data, and the evidence is shown. Here two good logs are altered on purpose.
"""

# %%
import sys
import tempfile
from pathlib import Path

import numpy as np
import pandas as pd

from frictioncli.inspection.inspect import inspect

day = Path(__file__).parents[1] / "sample_logs" / "kr10" / "day1"
logs = [day / "010_sweep_KRCIpo.csv", day / "012_heat-up_KRCIpo.csv"]
given = [Path(name) for name in sys.argv[2:]]  # after the work folder: logs of your own


# %% What is believed of each channel, and why
def show(paths):
    """Print what files hold, channel by channel."""
    found = inspect(paths)
    for file in found.files:
        print(f"{file.path.name}: {file.rows_kept} of {file.rows} rows usable")
        for joint in file.joints:
            for channel in joint.channels:
                unit = f"[{channel.unit_found}] read as {channel.unit_believed}"
                print(f"  {channel.column:28s} {unit:24s} {channel.evidence}")
        for note in file.notes:
            print(f"  note: {note}")
    return found


found = show(given or logs)

# %% The same logs with positions in radians and temperatures in Kelvin under the same headers
# A velocity beside the positions gives the radians away: without one the header would stand.
with tempfile.TemporaryDirectory() as folder:
    spoilt = []
    for log in logs:
        table = pd.read_csv(log, sep=";", encoding="cp1252")
        for name in table.columns:
            if "AxisPos" in name:
                velocity = name.replace("Pos", "Vel").replace("[°]", "[°/s]")
                table[velocity] = np.gradient(table[name], 0.012)
                table[name] = np.radians(table[name])
            if "temperatur" in name:
                table[name] = table[name] + 273.15
        spoilt.append(Path(folder, f"spoilt_{log.name}"))
        table.to_csv(spoilt[-1], sep=";", encoding="cp1252", index=False)
    print()
    show(spoilt)

# %% What the good ones suffice for
for data in found.joints:
    print(f"\njoint {data.joint}:")
    for stage in data.stages:
        print(f"  {stage.name:10s} {stage.suffices:9s} {stage.reason}")
