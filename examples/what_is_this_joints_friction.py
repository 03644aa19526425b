"""What is this joint's friction, with load, speed and temperature, and how sure is that."""

# %%
import sys
from pathlib import Path

import numpy as np

from frictioncli.model.document import read_models
from frictioncli.model.friction import friction_torque
from frictioncli.stages.fit import fit
from frictioncli.stages.ingest import ingest
from frictioncli.stages.pair import pair
from frictioncli.stages.separate import separate

logs = Path(__file__).parents[1] / "sample_logs" / "kr10"
work = Path(sys.argv[1] if len(sys.argv) > 1 else "friction-run")

# %% The chain, stage by stage; each writes its table into the work folder and says what it found
if not (work / "model.json").exists():
    print(ingest([logs], work))
    print(pair(work))
    print(separate(work))
    print(fit(work))

# %% The parameters of equation (16) with 95 % intervals; a notebook shows ``model`` as a table
(model,) = read_models(work / "model.json")
print(model.table())

# %% Friction without load: how much temperature takes
speeds = np.array([19.1, 39.4, 67.5, 101.2])
print(f"\n{'friction [N·m] at':>18}", *(f"{speed:>10g} deg/s" for speed in speeds))
for temperature in (25.0, 45.0, 65.0):
    torque = friction_torque(model.friction, load=0.0, speed=speeds, temperature=temperature)
    print(f"{temperature:>15g} °C", *(f"{value:>16.1f}" for value in torque))

# %% What load adds: alpha L^2, whatever the speed
load = 80.0
added = model.friction.alpha * load**2
print(f"\na load of {load:g} N·m adds {added:.1f} N·m")

# %% How far the data reach; beyond them the equation extrapolates
reach = {
    "speed": model.range.speed,
    "load": model.range.load,
    "temperature": model.range.temperature,
}
for name, (low, high) in reach.items():
    print(f"{name:12s} measured from {low:.4g} to {high:.4g}")
