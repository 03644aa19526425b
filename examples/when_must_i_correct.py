"""When must I correct the temperature, and what is the benefit.

While the robot works its friction is predicted from the motor's temperature; now and then a pair
of moves corrects that temperature (Algorithm 3). How often is enough?
"""

# %%
import sys
from pathlib import Path

import pandas as pd

from frictioncli.correction.settings import EvaluationGrid, ScheduleSettings
from frictioncli.stages.evaluate import evaluate
from frictioncli.stages.run import analyse
from frictioncli.stages.simulate import simulate

logs = Path(__file__).parents[1] / "sample_logs" / "kr10"
work = Path(sys.argv[1] if len(sys.argv) > 1 else "friction-run")
if not (work / "model.json").exists():
    analyse([logs], work)

# %% The paper's rule, never, and where the predicted uncertainty exceeds 2 N·m
for schedule in (
    ScheduleSettings(criterion="none"),
    ScheduleSettings(criterion="first_degree", k=5, tmax=3600),
    ScheduleSettings(criterion="uncertainty", bound=2.0),
):
    print(simulate(work, schedule), end="\n\n")

# %% The moments of the latter, and what was corrected
rows = pd.read_parquet(work / "schedule.parquet")
events = rows[rows["corrected"]]
for (run, phase), group in events.groupby(["run", "phase"], sort=False):
    moments = ", ".join(f"{minutes:.0f}" for minutes in group["time"] / 60)
    print(f"{run} {phase}: corrected at {moments} min of the run")
last = events.iloc[-1]
print(
    f"at last by {last['temperature_correction']:+.1f} °C:"
    f" friction obeyed {last['temperature_parameter']:.1f} °C"
)

# %% Error by number of corrections, over a grid of settings
print()
grid = EvaluationGrid(k=(2, 5, 10, 20), tmax=(1800, 3600, 7200), bound=(1, 2, 3, 4))
print(evaluate(work, grid))
