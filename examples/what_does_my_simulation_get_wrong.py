"""What does my simulation get wrong: which effect is missing, and how much it matters.

The fitted friction and gravity simulate the torque; the residual is tested against twenty physical
effects, with noise that drifts. The last run is held out to measure the gain.
"""

# %%
import sys
from pathlib import Path

from frictioncli.diagnosis.documents.document import read_diagnoses
from frictioncli.stages.run import analyse
from frictioncli.stages.simulate import simulate

logs = Path(__file__).parents[1] / "sample_logs" / "kr10"
work = Path(sys.argv[1] if len(sys.argv) > 1 else "friction-run")
if not (work / "diagnosis.json").exists():
    analyse([logs], work)

# %% The verdict, and each cause with its size and its parameters
(diagnosis,) = read_diagnoses(work / "diagnosis.json").values()
print("verdict:", diagnosis.verdict)
for cause in diagnosis.causes:
    print(f"\n{' or '.join(cause.effects)}: {cause.claim}")
    print(f"  {cause.equation}")
    print(f"  size {cause.size:.2f} N·m RMS, p-value {cause.p_value:.1g}")
    for name, parameter in cause.parameters.items():
        low, high = parameter.ci95 or (float("nan"), float("nan"))
        value = f"{parameter.estimate:.3g} {parameter.unit}"
        print(f"  {name} = {value} (95 %: {low:.3g} to {high:.3g})")
    print(f"  to settle it: {cause.experiment}")

# %% What it is worth on a day that it has not seen
gain = diagnosis.gain
print(
    f"\nmisfit of the simulated torque on a {gain.basis.replace('_', ' ')}:"
    f" {gain.rmse_before:.2f} -> {gain.rmse_after:.2f} N·m;"
    f" no model can go below {gain.noise_floor:.2f}"
)

# %% What these data could have shown, the smallest size found 4 times in 5
print("\nsmallest size that would have been named:")
for name, size in diagnosis.detectable.items():
    print(f"  {name:20s} {'cannot show it' if size is None else f'{size:.2f} N·m'}")

# %% Corrections with the extended model: hardly any is left to make
print()
print(simulate(work, extended=True))
