"""Real logs, and what is known of them from elsewhere."""

from dataclasses import dataclass
from pathlib import Path

MAPS = Path(__file__).parent / "real_maps"


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """A log or logs of one robot, each folder one run.

    Attributes
    ----------
    name : str
        Name of the case, and of its figures.
    title : str
        Robot and source.
    folders : tuple of str
        Folders of the logs.
    map : str or None
        Mapping file, where the channels cannot be found from the logs.
    joints : tuple of int or None
        Joints to read; all without it.
    known : str
        What is known of these logs from elsewhere.
    judgement : str
        What we think of the diagnosis, and where it is doubtful.
    refused : str
        What a user would call a refusal, right or wrong, as far as we see.
    doubt : str
        What a user would call wrong about a result, as far as we see.
    """

    name: str
    title: str
    folders: tuple[str, ...]
    map: str | None = None
    joints: tuple[int, ...] | None = None
    known: str = ""
    judgement: str = ""
    refused: str = ""
    doubt: str = ""


CASES = (
    Case(
        name="kuka-kr3-vel",
        title="KUKA KR3 R540, axis 3, PTP_Vel (github anjan211/kuka_controller_project)",
        folders=("kuka-kr3/PTP_Vel",),
        joints=(3,),
        known="Four speeds there and back on one morning, no temperature. By another program, in"
        " 5-degree bins: half-differences of 0.136, 0.312 and 0.387 N·m (motor side) at 46, 229 and"
        " 320 deg/s.",
        doubt="The fourth speed, 399 deg/s, is not paired because its constant part is too"
        " short. Three pairs fit a line but say little about its form; all friction is"
        " attributed to √v. Joint 1 turns during each forward move, and the program warns"
        " of it. It turns about the vertical, so gravity does not change, but the log"
        " cannot show that.",
    ),
    Case(
        name="kuka-kr3-combined",
        title="KUKA KR3 R540, PTP_Combined, another day",
        folders=("kuka-kr3/PTP_Combined",),
        known="Axes moving alone and together; few moves at constant speed.",
        refused="Only in part. Two pairs per joint do not determine a model, but they contain"
        " friction, and the independent script finds it. The program prints it as a result"
        " of `separate` and then ends with the refusal.",
    ),
    Case(
        name="xarm6-j2",
        title="UFactory xArm6, joint 2 (github TKL01/Kinova-Dashboard)",
        folders=("xarm6-j2",),
        map="xarm6-j2.toml",
        known="14 recordings at 2 Hz, two speeds, friction in the current [A], the load in a"
        " channel of its own [N·m]. Turning angles are random; the motor warms from 20 to"
        " 43 °C. Nearly all pairs are at 40 to 50 deg/s, and the load is a function of the"
        " angle, so structure along the load cannot be distinguished from structure along"
        " the angle.",
        doubt="Nearly all pairs are at two speeds. It is right that Coulomb friction is not"
        " determined; that all friction then grows with √v is an assumption.",
    ),
    Case(
        name="xarm6-j3",
        title="UFactory xArm6, joint 3: without, with and again without a weight",
        folders=("xarm6-j3/a_none", "xarm6-j3/b_weight", "xarm6-j3/c_none"),
        map="xarm6-j3.toml",
        known="The weight was in the hand in the second run only: the amplitude of the load is"
        " 13.4, 23.5 and 13.4 N·m. Friction falls with temperature in all runs without the"
        " weight. The change of payload is right. Each run has nearly one speed, 30, 40"
        " and 30 deg/s, and bins of 20 deg, so friction along the angle cannot be"
        " attributed to a delay or a play.",
    ),
    Case(
        name="kinova-gen3-j4",
        title="Kinova Gen3, joint 4 (github TKL01/Kinova-Dashboard)",
        folders=("kinova-gen3-j4",),
        joints=(4,),
        known="One speed and one temperature. In the first 20 s joints 2 and 6 drive to zero;"
        " what they add to the torque of joint 4 is not a step of its friction. Without"
        " these seconds nothing is found.",
        doubt="One speed and one temperature give a number, not a law. All pairs are in the"
        " pose that the other joints reach after 20 s.",
    ),
    Case(
        name="epos-drive1",
        title="maxon EPOS drive 1 (RViMLab/TRO2021-Dynamic-Modelling, MIT)",
        folders=("epos-drive1",),
        known="Files of a recorder without positions, one speed per file. Motor friction is"
        " often taken as proportional to speed; the base model has its square root.",
        doubt="Friction falls up to about 240 deg/s and then rises: a Stribeck curve with a"
        " linear term fits eleven times better than a line. The base model has neither and"
        " describes these data badly; the diagnosis names the rise and misses the fall.",
    ),
    Case(
        name="damiao-5",
        title="Damiao motor 5 on a bench (github"
        " YIZHIXIAOCANGSHU/Friction-Identification-for-Manipulators_usb2fdcan)",
        folders=("damiao-5",),
        map="damiao-5.toml",
        known="A staircase of speeds without stops, held for 1 s each; positions wrap at ±12.5 rad"
        " and advance 1.66 to 1.99 times the integral of velocity. By another program 0.0771 +"
        " 0.00324·√v N·m.",
        doubt="Pairs would use 4 % of the motion, most of which is sweeps between the holds;"
        " the regression uses 66 % of it, from 12 to 451 deg/s, and says so. The script's"
        " speeds differ from all but the lowest and the highest of these. Position and"
        " velocity contradict each other; the log does not show which one is wrong.",
    ),
    Case(
        name="ur10e-j1",
        title="UR10e, joint 1 (github shamilmamedov/dynamic_calibration)",
        folders=("ur10e-j1",),
        map="ur10e-j1.toml",
        known="The joint moves in sines, never at constant speed.",
        refused="Yes, without a map: nothing in the file says what its 31 columns are.",
        doubt="The unit of the torque is wrong with the suggested map: columns 14 to 19 are"
        " currents, and the map says N·m, with the remark that the values do not show it."
        " The figures are right in amperes.",
    ),
    Case(
        name="ur3-cobotops",
        title="UR3 (UCI dataset 963, CC BY 4.0)",
        folders=("ur3-cobotops",),
        known="Currents, temperatures and speeds at 1 Hz, no positions.",
        refused="Yes: without positions, gravity cannot be separated from friction in a robot arm.",
    ),
    Case(
        name="nist-ur5",
        title="UR5 (NIST, doi 10.18434/M31962)",
        folders=("nist-ur5",),
        known="All joints move at once on one trajectory.",
        refused="Yes: every joint moves together with the others, and no `--urdf` is given. Some"
        " users would prefer a number with a warning.",
    ),
)
"""In the order of the page."""
