"""Template of the C header in parts; ``$`` marks placeholders."""

HEAD = """\
/*
$remarks
 *
 * Units: N.m or A as said below, deg/s, degC, s. Speeds are absolute values.
 * C99, needs <math.h> only. No heap, and no state outside struct $prefix.
 * Do not compile it with -ffast-math: where there is no solution it returns NAN.
 */
#ifndef ${PREFIX}_H
#define ${PREFIX}_H

#include <math.h>

$constants

/* Parameters and state of the joint; fill it with ${prefix}_init. */
struct $prefix {
    double tau_c;      /* Coulomb friction [$unit] */
    double alpha;      /* load coefficient [$alpha_unit] */
    double beta;       /* viscous coefficient that does not fall with temperature [$viscous_unit] */
    double gamma;      /* viscous coefficient that falls, at 0 degC [$viscous_unit] */
    double delta;      /* rate at which gamma falls with temperature [1/degC] */
$fields};

static inline void ${prefix}_init(struct $prefix *joint)
{
    joint->tau_c = ${PREFIX}_TAU_C;
    joint->alpha = ${PREFIX}_ALPHA;
    joint->beta = ${PREFIX}_BETA;
    joint->gamma = ${PREFIX}_GAMMA;
    joint->delta = ${PREFIX}_DELTA;
$initial_values}

/* 1 where the model was measured, 0 where it extrapolates. */
static inline int ${prefix}_in_range(
    double load, double speed, double temperature)
{
    return $in_range;
}

/* Friction torque [$unit] by equation (16): load [$load_unit], speed [deg/s] >= 0,
 * temperature [degC]. It opposes the motion. */
static inline double ${prefix}_friction(
    const struct $prefix *joint, double load, double speed, double temperature)
{
    double viscous = joint->beta + joint->gamma * exp(-joint->delta * temperature);
    return joint->tau_c + joint->alpha * (load * load) + viscous * sqrt(speed);
}
"""

CORRECTION_FIELDS = """\
    double k;          /* scale of criterion (20) [1] */
    double tmax;       /* time after which a correction is forced [s] */
    int latest_degree; /* 1: the latest change by 1 degC counts in (20); 0: the first one */
    /* state */
    double correction;        /* temperature correction in force [degC] */
    double motor_temperature; /* the latest [degC] */
    double registered;        /* the same as the criterion sees it [degC] */
    double time;              /* of the latest sample [s] */
    double corrected_at;      /* time of the last correction [s] */
    double from_time;         /* where the change by a degree under way began [s] */
    double from_registered;   /* [degC] */
    double degree_time;       /* time that a change by a degree took [s] */
    int begun;                /* whether a sample was received */
    int corrected;            /* whether a correction was tried */
    int degree_known;         /* whether degree_time is known */
"""

CORRECTION_INITIAL_VALUES = """\
    joint->k = ${PREFIX}_K;
    joint->tmax = ${PREFIX}_TMAX;
    joint->latest_degree = ${PREFIX}_LATEST_DEGREE;
    joint->correction = 0.0;
    joint->motor_temperature = 0.0;
    joint->registered = 0.0;
    joint->time = 0.0;
    joint->corrected_at = 0.0;
    joint->from_time = 0.0;
    joint->from_registered = 0.0;
    joint->degree_time = 0.0;
    joint->begun = 0;
    joint->corrected = 0;
    joint->degree_known = 0;
"""

GEAR_FIELDS = """\
    /* state of the gear: by its time constant [0], and by the ends of the interval [1], [2] */
    double lag[3];              /* motor temperature, filtered less unfiltered [degC] */
    double heat[3];             /* friction power filtered [1] */
    double housing_lag[3];      /* housing temperature, filtered less unfiltered [degC] */
    double hidden_lag;          /* housing that is not measured, less the motor [degC] */
    double started_at;          /* time of the first sample [s] */
    double housing_temperature; /* the latest known [degC] */
"""

GEAR_INITIAL_VALUES = """\
    {
        int i;
        for (i = 0; i < 3; i++) {
            joint->lag[i] = 0.0;
            joint->heat[i] = 0.0;
            joint->housing_lag[i] = 0.0;
        }
    }
    joint->hidden_lag = 0.0;
    joint->started_at = 0.0;
    joint->housing_temperature = 0.0;
"""

INVERSE = """\

/* Temperature [degC] at which (16) gives a friction torque [$unit], by equation (18); NAN where
 * none does. load [$load_unit], speed [deg/s] > 0. */
static inline double ${prefix}_temperature(
    const struct $prefix *joint, double friction, double load, double speed)
{
    double viscous = friction - joint->tau_c - joint->alpha * (load * load);
    double argument = viscous / (joint->gamma * sqrt(speed)) - joint->beta / joint->gamma;
    double found;
    if (!(argument > 0.0))
        return NAN;
    found = -log(argument) / joint->delta;
    return isfinite(found) ? found : NAN;
}
"""

UPDATE = """\

/* Take in a sample: time [s], not before the last one; motor temperature [degC]; the same as the
 * criterion is to see it, in whole degrees, if a finer value is known, else the same value.$more */
static inline void ${prefix}_update(
    struct $prefix *joint, double time, double motor_temperature, double registered$arguments)
{
$gear_step    joint->time = time;
    joint->motor_temperature = motor_temperature;
    joint->registered = registered;
    joint->begun = 1;
    if (joint->corrected && (joint->latest_degree || !joint->degree_known)
        && fabs(registered - joint->from_registered) >= 1.0 - 1e-9) {
        joint->degree_time = time - joint->from_time;
        joint->degree_known = 1;
        if (joint->latest_degree) {
            joint->from_time = time;
            joint->from_registered = registered;
        }
    }
}

/* 1 when criterion (20) asks for a correction; so it does at the first sample. */
static inline int ${prefix}_is_due(const struct $prefix *joint)
{
    double limit = joint->tmax;
    if (!joint->begun || !joint->corrected)
        return joint->begun;
    if (joint->degree_known && joint->k * joint->degree_time < limit)
        limit = joint->k * joint->degree_time;
    return joint->time - joint->corrected_at > limit;
}
"""

GEAR_ARGUMENTS = ",\n    double housing_temperature, double power"

GEAR_COMMENT = """
 * housing_temperature [degC], NAN if unknown: then the latest one known, or else the motor's;
 * power: mean of friction torque times speed since the sample before [$unit.deg/s], what warms the
 * gear."""

LAGGING = """\

/* A first-order filter's output less its input after the input rose linearly over a duration, by
 * the same before and the ratio of the duration to the time constant. */
static inline double ${prefix}_lagging(double lag, double ratio, double rise)
{
    return exp(-ratio) * lag - rise * (ratio > 0.0 ? -expm1(-ratio) / ratio : 1.0);
}
"""

GEAR_STEP = """\
    static const double time_constant[3] = ${PREFIX}_TIME_CONSTANTS;
    double duration = joint->begun && time > joint->time ? time - joint->time : 0.0;
    double warming = joint->begun ? motor_temperature - joint->motor_temperature : 0.0;
    double before = joint->housing_temperature;
    int i;
    if (!joint->begun) {
        joint->started_at = time;
        before = motor_temperature;
    }
    if (${PREFIX}_HOUSING_TIME_CONSTANT > 0.0) {
        joint->hidden_lag = ${prefix}_lagging(
            joint->hidden_lag, duration / ${PREFIX}_HOUSING_TIME_CONSTANT, warming);
        housing_temperature = motor_temperature + joint->hidden_lag;
    }
    joint->housing_temperature = isnan(housing_temperature) ? before : housing_temperature;
    for (i = 0; joint->begun && i < 3; i++) {
        double ratio = duration / time_constant[i];
        joint->lag[i] = ${prefix}_lagging(joint->lag[i], ratio, warming);
        joint->housing_lag[i] = ${prefix}_lagging(
            joint->housing_lag[i], ratio, joint->housing_temperature - before);
        joint->heat[i] = exp(-ratio) * joint->heat[i]
                         - power / ${PREFIX}_REFERENCE_POWER * expm1(-ratio);
    }
"""

GEAR = """\

/* What the filters add to the temperature of the gear [degC]. */
static inline double ${prefix}_gear_filtered(const struct $prefix *joint, int i)
{
    return ${PREFIX}_LAG_SHARE * joint->lag[i]
           + ${PREFIX}_FRICTION_HEATING * joint->heat[i]
           + ${PREFIX}_HOUSING_LAG_SHARE * joint->housing_lag[i];
}

/* How much warmer than measured the place of friction is [degC]. */
static inline double ${prefix}_gear_excess(const struct $prefix *joint)
{
    double base = $base_temperature;
    return ${PREFIX}_LAG_SHARE * (joint->motor_temperature - base)
           + (${PREFIX}_HOUSING_SHARE + ${PREFIX}_HOUSING_LAG_SHARE)
                 * (joint->housing_temperature - base)
           + ${prefix}_gear_filtered(joint, 0);
}

/* Its standard deviation [degC]: by the time constant's interval and the unknown start. */
static inline double ${prefix}_gear_uncertainty(const struct $prefix *joint)
{
    static const double time_constant[3] = ${PREFIX}_TIME_CONSTANTS;
    double ends = ${prefix}_gear_filtered(joint, 2) - ${prefix}_gear_filtered(joint, 1);
    double age = joint->begun ? joint->time - joint->started_at : 0.0;
    double start = ${PREFIX}_START_SD * exp(-age / time_constant[0]);
    return sqrt(ends * ends / (4.0 * 1.959963984540054 * 1.959963984540054) + start * start);
}
"""

BEYOND = """\

/* Friction torque [$unit] that the extended model adds to (16) at present: its effects, and the
 * changes of the parameters that were refitted with them, at the temperature of the gear. */
static inline double ${prefix}_beyond(
    const struct $prefix *joint, double load, double speed)
{
    double measured = $base_temperature;
    double temperature = measured + $excess;
    double viscous = ${PREFIX}_BETA_CHANGE
                     + exp(-${PREFIX}_DELTA * temperature)
                           * (${PREFIX}_GAMMA + ${PREFIX}_GAMMA_CHANGE
                              - ${PREFIX}_GAMMA * ${PREFIX}_DELTA_CHANGE * temperature)
                     - ${PREFIX}_GAMMA * exp(-${PREFIX}_DELTA * measured);
    double torque = ${PREFIX}_TAU_C_CHANGE + ${PREFIX}_ALPHA_CHANGE * (load * load)
                    + viscous * sqrt(speed);
$terms    return torque;
}
"""

CORRECT = """\

/* Correct the temperature, equations (18) and (19), by a pair measured at about
 * ${PREFIX}_CORRECTION_SPEED: its friction torque [$unit] and load [$load_unit] by (8), its speed
 * [deg/s] and the motor temperature meanwhile [degC]. 0 where (18) has no solution: the last
 * correction then stays in force; the criterion starts again in either case. */
static inline int ${prefix}_correct(
    struct $prefix *joint, double friction, double load, double speed,
    double motor_temperature)
{
    double base = friction$minus_extension;
    double found = ${prefix}_temperature(joint, base, load, speed);
    joint->corrected_at = joint->time;
    joint->from_time = joint->time;
    joint->from_registered = joint->registered;
    joint->degree_known = 0;
    joint->corrected = 1;
    if (isnan(found))
        return 0;
    joint->correction = found - motor_temperature;
    return 1;
}

/* Friction torque [$unit] at present, at the corrected temperature (17). */
static inline double ${prefix}_predicted(
    const struct $prefix *joint, double load, double speed)
{
    double temperature = joint->motor_temperature + joint->correction;
    return ${prefix}_friction(joint, load, speed, temperature)$plus_extension;
}
"""

TAIL = """\

#endif
"""
