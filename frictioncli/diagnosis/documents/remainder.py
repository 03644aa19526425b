r"""What the extended model still misses, and along which axis.

A model is adequate where its misfit on a run that it has not seen is that of the noise,
:math:`r \approx n`. From :math:`r > 1.25\,n` on something is left, of RMS
:math:`\sqrt{r^2 - n^2}`.
"""

import numpy as np

from frictioncli.diagnosis.documents.remainder_record import RemainderRecord
from frictioncli.diagnosis.fit.extension import misfits
from frictioncli.diagnosis.joint_diagnosis import Diagnosis
from frictioncli.diagnosis.search.largest_structure import left_structure
from frictioncli.diagnosis.search.new_run_changes import ADEQUATE


def remainder_record(diagnosis: Diagnosis) -> RemainderRecord | None:
    """Return what a diagnosis leaves on the rows it is judged on; None where that is noise.

    Parameters
    ----------
    diagnosis : Diagnosis
        The diagnosis of a joint.
    """
    problem, floor = diagnosis.judged, diagnosis.floor
    # the base as fitted may be that of a torque freed of its delay, which these rows have
    friction, load = misfits(problem, diagnosis.predicted)
    rmse = float(np.sqrt(np.mean(problem.squared(friction, load))))
    if rmse <= ADEQUATE * floor:
        return None
    most = left_structure(problem, friction, load)
    size = float(np.sqrt(rmse**2 - floor**2))
    return RemainderRecord(
        basis="within_run" if diagnosis.held_out is None else "new_run",
        rmse=rmse,
        noise_floor=floor,
        size=size,
        axis=most.axis,
        channel=most.channel,
        # the noise that is taken off is another estimate in either
        axis_size=min(most.size, size),
    )
