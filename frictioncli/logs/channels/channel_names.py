"""Quantities of a log's channels, and the names that controllers and loggers give them."""

from dataclasses import dataclass

TIME = "time"
POSITION = "position"
VELOCITY = "velocity"
TORQUE = "torque"
MOTOR_TEMPERATURE = "motor_temperature"
HOUSING_TEMPERATURE = "housing_temperature"
LOAD = "load"
OTHER_SPEED = "other_speed"
"""Not a channel of a log: the speed of the fastest other joint, from its position."""
OTHER_JOINTS = "other_joints"
"""Not a channel of a log: which other joints move, from their positions."""
PAYLOAD = "payload"
"""What is carried: a channel of a log, or what the program that ran says."""
POSE = "pose"
"""Not a channel of a log: where the other joints stand, as a number."""

INTEGRATED = "integral of velocity"
"""Name of the position that is made where a log has none."""

TOOL = "tool"
MAX_JOINT = 32767
"""Largest number of a joint, which the tables keep in 16 bits."""
CHANNELS = (
    TIME,
    POSITION,
    VELOCITY,
    TORQUE,
    MOTOR_TEMPERATURE,
    HOUSING_TEMPERATURE,
    LOAD,
    PAYLOAD,
)

JOINT_SIDE = "joint"
MOTOR_SIDE = "motor"


@dataclass(frozen=True, slots=True)
class Meaning:
    """What a channel name stands for.

    Attributes
    ----------
    quantity : str
        One of :data:`CHANNELS` or ``TOOL``.
    side : str
        Side of the gear, ``joint`` or ``motor``; "" where the name does not tell it.
    rank : int
        Order of preference among the channels of one quantity, lowest first. Motor torque contains
        all friction of the drive train, gear torque only a part of it; motor current comes last.
        For ``TOOL``, 0 to 2 stand for x, y and z.
    unit : str
        Usual unit where the header names none; "" where there is no usual one.
    """

    quantity: str
    side: str = JOINT_SIDE
    rank: int = 0
    unit: str = ""


# Measured values only: names of commands (Cmd, Soll, target) and of differences are left out.
_ALIASES: tuple[tuple[Meaning, str], ...] = (
    (
        Meaning(TIME),
        "zeit time t timestamp zeitstempel sekunden seconds elapsed elapsedtime robottime tsec"
        " timesec times zeits temps datetime recordtime controllertime sec"
        " tiempo tempo stamp secs",
    ),
    (
        Meaning(TIME, rank=1, unit="ms"),
        "sample timems zeitms timestampms millis timemillis mstoday",
    ),
    (
        Meaning(POSITION),
        "axisposact axispos axisact axisactmeas position positions pos jointposition jointpositions"
        " actualposition actualjointposition positionact actpos posact q actualq aipos mp stateq"
        " robotactualjointpositions angle jointangle winkel achswinkel gelenkwinkel istwinkel"
        " axisangle axisposition achsposition jointpos qact observationstate observationqpos"
        " positionachse theta linkposition linkangle outputposition outputangle"
        " posicion posicin posizione linkpos outputpos apos"
        " stateposition statepos angles jointangles mechpos dofpos",
    ),
    (
        Meaning(POSITION, MOTOR_SIDE),
        "istposition motorposition motorpos drivepositionact motorangle motorwinkel",
    ),
    (
        Meaning(VELOCITY),
        "axisvelact axisvel velocity velocities vel jointvelocity jointvelocities actualvelocity"
        " velocityact velact qd dq qdot actualqd statedq robotactualjointvelocities speed"
        " geschwindigkeit achsgeschwindigkeit gelenkgeschwindigkeit axisvelocity jointvel"
        " axisspeed jointspeed actvelo actvel observationvelocity observationqvel"
        " vitesse omega geschwindigkeitachse thetadot linkvelocity outputvelocity"
        " velocidad velocita velocit linkvel outputvel fspd"
        " statevelocity statevel spd mechvel dofvel",
    ),
    (Meaning(POSITION, unit="turn"), "posestimate"),
    (Meaning(VELOCITY, unit="turn/s"), "velestimate"),
    (Meaning(VELOCITY, unit="rpm"), "rpm"),
    (
        Meaning(VELOCITY, MOTOR_SIDE),
        "istgeschwindigkeit motorvelocity motorspeed motorvel motorgeschwindigkeit",
    ),
    (Meaning(TORQUE, MOTOR_SIDE, 0), "drivemotortorqact motortorqact drivemotortorq"),
    (
        Meaning(TORQUE, "", 0),
        "istmoment istdrehmoment motortorque motormoment motortorq taum taumotor motortau",
    ),
    (
        Meaning(TORQUE, JOINT_SIDE, 1),
        "torque torques jointtorque jointtorques axistorque drehmoment moment tau effort"
        " torqueaxisact actualtorque torqueact mt statetauj tauj measuredtorque achsmoment"
        " gelenkmoment torqact axistorqact acttorque acttorq observationeffort observationtorque"
        " tauest trq eff couple drehmomentachse jointeffort jointefforts acttrq trqact"
        " linktorque outputtorque coppia taumsr msrtorque currentastorque torquecur torquecurrent"
        " statetau statetorque stateeffort tq taumeas taumeasured tor doftorque",
    ),
    (Meaning(TORQUE, JOINT_SIDE, 2), "geartorqact geartorque geartorq getriebemoment"),
    (
        Meaning(TORQUE, MOTOR_SIDE, 3, "A"),
        "iststrom strom current currents motorcurrent motorstrom actualcurrent actualjointcurrent"
        " robotactualjointcurrent currentact actcurrent curr jointcurrent macur observationcurrent"
        " iqmeasured currentmotor iq iqa iqact iqactual qcurrent currentq qaxiscurrent motoriq cur"
        " motorcurr motorcur courant corriente corrente currmotor motorcurrents actuali iqf",
    ),
    (Meaning(TORQUE, MOTOR_SIDE, 3, "%"), "curract"),
    (
        Meaning(MOTOR_TEMPERATURE),
        "motortemperatur motortemperature motortemperatures mottemp motortemp motortempact"
        " temperatur temperature temperatures temp jointtemperature jointtemperatures jointtemp"
        " robotjointtemp motort tm wicklungstemperatur temperaturemotor tmotor tmot tempmotor"
        " servotemperature servotemp actuatortemperature actuatortemp statortemperature statortemp"
        " coiltemperature coiltemp temperatura temperaturamotor temperaturamotore"
        " temperaturmotor windingtemperature windingtemp twinding trotor temprotor rotortemp"
        " rotortemperature temperaturerotor tcoil",
    ),
    (
        Meaning(HOUSING_TEMPERATURE),
        "gehaeusetemperatur gehausetemperatur housingtemperature housingtemp gehaeusetemp"
        " casetemperature casingtemperature surfacetemperature gehuse gehusetemperatur tc"
        " oberflaechentemperatur housingtempact thousing temphousing tgehaeuse tcase tempcase",
    ),
    (Meaning(LOAD), "load loadtorque lastmoment loadtorqueact"),
    (Meaning(PAYLOAD, unit="kg"), "payload payloadmass payloadact nutzlast traglast"),
    (Meaning(TOOL, rank=0), "xact toolx tcpx robotcartesiancoordtoolx x"),
    (Meaning(TOOL, rank=1), "yact tooly tcpy robotcartesiancoordtooly y"),
    (Meaning(TOOL, rank=2), "zact toolz tcpz robotcartesiancoordtoolz z"),
)
MEANINGS = {name: meaning for meaning, names in _ALIASES for name in names.split()}
"""Meaning by channel name in lower-case letters and digits, without joint number."""

TORQUE_REFERENCES = frozenset(
    ("torquereference", "referencetorque", "torqueref", "reftorque", "trqref")
)
"""Names of what a drive asks of its motor: all that some drives log of their torque."""
